/* The test program's machine: an emulated Cortex-M board, whose files are the emulator's (semihosting).
 *
 * The stack is painted from the end of the statics up to the caller before each call; the lowest word that lost its paint
 * says how deep the call went. Nothing interrupts.
 */
#include "port.h"

#define PAINT 0xCCCCCCCCu

/* Labels of the linker script. */
extern uint32_t _data_start, _data_end, _data_image, _bss_start, _bss_end, _stack_top;

int program(void);

/* Requests to the emulator: Arm, Semihosting for AArch32 and AArch64, release 3. */
enum { SYS_OPEN = 1, SYS_WRITE = 5, SYS_READ = 6, SYS_EXIT = 0x18 };

static uint32_t calls, answers;

static uint32_t ask(uint32_t operation, const void *parameters)
{
    register uint32_t r0 __asm("r0") = operation;
    register const void *r1 __asm("r1") = parameters;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static uint32_t open_file(const char *name, uint32_t length, uint32_t mode)
{
    uint32_t parameters[3];
    parameters[0] = (uint32_t)(uintptr_t)name;
    parameters[1] = mode;
    parameters[2] = length;
    return ask(SYS_OPEN, parameters);
}

int port_open(void)
{
    calls = open_file("calls.bin", 9, 1);
    answers = open_file("answers.bin", 11, 5);
    return calls != 0xFFFFFFFFu && answers != 0xFFFFFFFFu;
}

static uint32_t transfer(uint32_t operation, uint32_t file, const uint8_t *bytes, size_t count)
{
    uint32_t parameters[3];
    parameters[0] = file;
    parameters[1] = (uint32_t)(uintptr_t)bytes;
    parameters[2] = (uint32_t)count;
    /* What is answered is what was left undone. */
    return ask(operation, parameters);
}

size_t port_read(uint8_t *bytes, size_t count)
{
    return count - transfer(SYS_READ, calls, bytes, count);
}

void port_write(const uint8_t *bytes, size_t count)
{
    if (transfer(SYS_WRITE, answers, bytes, count) != 0) {
        port_exit(3);
    }
}

__attribute__((naked)) static uint32_t stack_pointer(void)
{
    __asm("mov r0, sp\n bx lr");
}

/* As deep as this file's own functions go, bytes. */
#define OWN 64u

static uint32_t painted_from;

__attribute__((noinline)) void port_paint_stack(void)
{
    volatile uint32_t *word = (volatile uint32_t *)&_bss_end;
    painted_from = stack_pointer();
    while ((uint32_t)(uintptr_t)word < painted_from - OWN) {
        *word++ = PAINT;
    }
}

__attribute__((noinline)) uint32_t port_stack_bytes(void)
{
    const volatile uint32_t *word = (const volatile uint32_t *)&_bss_end;
    while (*word == PAINT) {
        word++;
    }
    return painted_from - (uint32_t)(uintptr_t)word;
}

void port_exit(int code)
{
    /* ADP_Stopped_ApplicationExit, or a reason that the emulator takes for a failure. */
    (void)ask(SYS_EXIT, (const void *)(uintptr_t)(code == 0 ? 0x20026u : 0x20023u));
    for (;;) {
    }
}

/* Where a panic of the library would end: none is reachable. */
void rai_panic(void)
{
    port_exit(4);
}

static void fault(void)
{
    port_exit(5);
}

static void reset(void)
{
    uint32_t *from = &_data_image, *to = &_data_start;
    /* The floating-point unit: CPACR. */
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20;
    __asm volatile("dsb\n isb");
    while (to < &_data_end) {
        *to++ = *from++;
    }
    for (to = &_bss_start; to < &_bss_end; to++) {
        *to = 0;
    }
    port_exit(program());
}

/* Initial stack pointer, reset, and the faults. */
typedef void (*vector)(void);
__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    vector handlers[6];
} vectors = {&_stack_top, {reset, fault, fault, fault, fault, fault}};
