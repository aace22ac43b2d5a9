/* The machine that a peer runs on: an emulated Cortex-M whose files are the emulator's (semihosting).
 *
 * Each epoch is judged from each start, and a line about it goes to answers.txt: ticks, return value, whether the position
 * is valid, the position's three doubles as hexadecimal words, and the satellites that were left out.
 *
 * The stopwatch is that of our own measuring image: the system timer counts down from its largest value, nothing
 * interrupts, and what a look at the timer costs is taken off.
 */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "epoch.h"
#include "epochs.h"

/* Labels of the linker script. */
extern uint8_t bss_start, bss_end, heap_start, heap_end, stack_top;

/* Requests to the emulator: Arm, Semihosting for AArch32 and AArch64, release 3. */
enum { SYS_OPEN = 1, SYS_WRITE = 5, SYS_EXIT = 0x18 };
enum { WRITE_BINARY = 5, SUCCESS = 0x20026, FAILURE = 0x20023 };

static uintptr_t ask(uintptr_t operation, uintptr_t parameters)
{
    register uintptr_t r0 __asm("r0") = operation;
    register uintptr_t r1 __asm("r1") = parameters;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void end(uintptr_t reason)
{
    for (;;) {
        (void)ask(SYS_EXIT, reason);
    }
}

static void write_text(uintptr_t file, const char *text)
{
    const uintptr_t parameters[3] = {file, (uintptr_t)text, strlen(text)};
    if (ask(SYS_WRITE, (uintptr_t)parameters) != 0) {
        end(FAILURE);
    }
}

/* The heap, which RTKLIB's matrices come from. */
void *_sbrk(ptrdiff_t bytes)
{
    static uint8_t *top = &heap_start;
    uint8_t *const block = top;
    if (bytes > &heap_end - top) {
        return (void *)-1;
    }
    top += bytes;
    return block;
}

/* System timer: control, reload and current value; 24 bits. */
#define SYST ((volatile uint32_t *)0xE000E010u)
enum { TIMER_MASK = 0x00FFFFFF, TIMER_ON_CORE_CLOCK = 5 };

static void nothing(void)
{
}

__attribute__((noinline)) static uint32_t ticks_of(void (*stage)(void))
{
    const uint32_t before = SYST[2];
    stage();
    return (before - SYST[2]) & TIMER_MASK;
}

static void report(uintptr_t file, uint32_t ticks, const struct epoch *epoch)
{
    struct answer answer;
    uint64_t bits[3];
    char line[160];
    memset(&answer, 0, sizeof answer);
    peer_answer(&answer);
    memcpy(bits, answer.position_m, sizeof bits);
    snprintf(line, sizeof line, "%lu %d %d", (unsigned long)ticks, answer.code, answer.is_valid);
    write_text(file, line);
    for (int axis = 0; axis < 3; axis++) {
        snprintf(line, sizeof line, " %08lx%08lx", (unsigned long)(bits[axis] >> 32), (unsigned long)bits[axis]);
        write_text(file, line);
    }
    for (int index = 0; index < SATELLITES; index++) {
        const struct satellite *satellite = &epoch->satellites[index];
        if (answer.is_out[index]) {
            snprintf(line, sizeof line, " %c%02d", satellite->letter, satellite->number);
            write_text(file, line);
        }
    }
    write_text(file, "\n");
}

static void run_all(void)
{
    static const char name[] = "answers.txt";
    const uintptr_t parameters[3] = {(uintptr_t)name, WRITE_BINARY, sizeof name - 1};
    const uintptr_t file = ask(SYS_OPEN, (uintptr_t)parameters);
    SYST[1] = TIMER_MASK;
    SYST[2] = 0;
    SYST[0] = TIMER_ON_CORE_CLOCK;
    const uint32_t overhead = ticks_of(nothing);
    for (size_t start = 0; start < sizeof STARTS_M / sizeof *STARTS_M; start++) {
        for (size_t epoch = 0; epoch < sizeof EPOCHS / sizeof *EPOCHS; epoch++) {
            peer_prepare(&EPOCHS[epoch], STARTS_M[start]);
            const uint32_t ticks = ticks_of(peer_run);
            report(file, ticks - overhead, &EPOCHS[epoch]);
        }
    }
    end(SUCCESS);
}

static void fault(void)
{
    end(FAILURE);
}

static void reset(void)
{
    /* The floating-point unit: CPACR. */
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20;
    __asm volatile("dsb\n isb");
    memset(&bss_start, 0, (size_t)(&bss_end - &bss_start));
    run_all();
}

/* Initial stack pointer, reset, and the faults. */
__attribute__((section(".vectors"), used)) const struct {
    const void *stack;
    void (*handlers[6])(void);
} vectors = {&stack_top, {reset, fault, fault, fault, fault, fault}};
