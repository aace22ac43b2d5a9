/* Every function of the library for C, called as a file says, with what each gave written to another.
 *
 *   call    kind, length (4 bytes), payload           little-endian, as all that is behind
 *   answer  kind, status, stack (4), length (4), payload
 *
 *   kind  payload of the call                                   payload of the answer
 *   's'                                                         version, sizes, alignments, 4 bytes each
 *   'p'   phase, method, policy, clock aiding                   the settings
 *   'm'   time (8), ranges                                      the verdict
 *   'f'
 *   'n'                                                         accuracy, residuals of the monitor
 *   'i'                                                         sentences
 *   'g'   time (8), bytes                                       judged, pin, state, reason, the report, sentences
 *   't'   time (8)                                              the same
 *   'c'   bytes                                                 the same
 *   'k'   key, NUL, values, NUL                                 the same
 *   'a'                                                         accuracy, velocity, residuals of the receiver, counters
 *
 * With MONITOR_ALONE it is a program for a library without the receiver.
 */
#include "port.h"
#include "rai.h"

#define MOST 8192u

static rai_monitor_t monitor;
static rai_range_t ranges[RAI_MAX_SATELLITES];
static rai_residual_t residuals[RAI_MAX_SATELLITES];
static uint8_t payload[MOST];
#ifndef MONITOR_ALONE
static rai_receiver_t receiver;
static uint8_t sentences[4096];
static rai_text_t text;
#endif

static void copy(void *to, const void *from, size_t count)
{
    uint8_t *t = (uint8_t *)to;
    const uint8_t *f = (const uint8_t *)from;
    while (count-- > 0) {
        *t++ = *f++;
    }
}

static uint32_t length_at(const uint8_t *bytes)
{
    uint32_t length;
    copy(&length, bytes, sizeof length);
    return length;
}

static void answer(uint8_t kind, rai_status_t status, uint32_t stack, size_t length)
{
    uint8_t head[10];
    uint32_t count = (uint32_t)length;
    head[0] = kind;
    head[1] = status;
    copy(&head[2], &stack, sizeof stack);
    copy(&head[6], &count, sizeof count);
    port_write(head, sizeof head);
}

static void answer_whole(uint8_t kind, rai_status_t status, uint32_t stack, const void *bytes, size_t length)
{
    answer(kind, status, stack, length);
    port_write((const uint8_t *)bytes, length);
}

static void sizes(void)
{
    uint32_t said[7] = {0};
    said[0] = rai_abi_version();
    said[1] = (uint32_t)rai_monitor_size();
    said[2] = (uint32_t)rai_monitor_align();
    said[3] = RAI_MONITOR_SIZE;
#ifndef MONITOR_ALONE
    said[4] = (uint32_t)rai_receiver_size();
    said[5] = (uint32_t)rai_receiver_align();
    said[6] = RAI_RECEIVER_SIZE;
#endif
    answer_whole('s', RAI_STATUS_OK, 0, said, sizeof said);
}

static void prepare(void)
{
    static rai_settings_t settings;
    rai_status_t status;
    uint32_t stack;
    settings.size = (uint32_t)sizeof settings;
    status = rai_settings_preset(&settings, payload[0]);
    settings.method = payload[1];
    settings.policy = payload[2];
    settings.clock_aid = payload[3];
    port_paint_stack();
    if (status == RAI_STATUS_OK) {
        status = rai_monitor_init(&monitor, sizeof monitor, &settings);
    }
    stack = port_stack_bytes();
    answer_whole('p', status, stack, &settings, sizeof settings);
}

static void judge(uint32_t length)
{
    static rai_verdict_t verdict;
    size_t count = (length - 8u) / sizeof ranges[0];
    rai_status_t status;
    uint32_t stack;
    double time_s;
    copy(&time_s, payload, sizeof time_s);
    copy(ranges, payload + 8, count * sizeof ranges[0]);
    verdict.size = (uint32_t)sizeof verdict;
    port_paint_stack();
    status = rai_monitor_judge(&monitor, time_s, ranges, count, &verdict);
    stack = port_stack_bytes();
    answer_whole('m', status, stack, &verdict, sizeof verdict);
}

static void forget(void)
{
    rai_status_t status;
    uint32_t stack;
    port_paint_stack();
    status = rai_monitor_forget(&monitor);
    stack = port_stack_bytes();
    answer('f', status, stack, 0);
}

static void explain(void)
{
    static rai_accuracy_t accuracy;
    size_t count = 0;
    rai_status_t status;
    uint32_t stack;
    accuracy.size = (uint32_t)sizeof accuracy;
    port_paint_stack();
    status = rai_monitor_accuracy(&monitor, &accuracy);
    if (status == RAI_STATUS_OK) {
        status = rai_monitor_residuals(&monitor, residuals, RAI_MAX_SATELLITES, &count);
    }
    stack = port_stack_bytes();
    answer('n', status, stack, sizeof accuracy + count * sizeof residuals[0]);
    port_write((const uint8_t *)&accuracy, sizeof accuracy);
    port_write((const uint8_t *)residuals, count * sizeof residuals[0]);
}

#ifndef MONITOR_ALONE
static void start(void)
{
    rai_status_t status;
    uint32_t stack;
    text.bytes = sentences;
    text.capacity = sizeof sentences;
    text.length = 0;
    text.lost = 0;
    port_paint_stack();
    status = rai_receiver_init(&receiver, sizeof receiver, &text);
    stack = port_stack_bytes();
    answer_whole('i', status, stack, sentences, text.length);
}

/* A call that may say something. */
static void hear(uint8_t kind, uint32_t length)
{
    static rai_verdict_t report;
    rai_status_t status;
    uint8_t facts[4];
    uint32_t stack;
    uint64_t now_ms;
    copy(&now_ms, payload, sizeof now_ms);
    facts[0] = 0;
    text.length = 0;
    port_paint_stack();
    if (kind == 'g') {
        status = rai_receiver_gnss(&receiver, payload + 8, length - 8u, now_ms, &text, &facts[0]);
    } else if (kind == 't') {
        status = rai_receiver_tick(&receiver, now_ms, &text);
    } else if (kind == 'k') {
        const char *key = (const char *)payload, *values = key;
        while (*values++ != 0) {
        }
        status = rai_receiver_set(&receiver, key, *values == 0 ? NULL : values, &text);
    } else {
        status = rai_receiver_command(&receiver, payload, length, &text);
    }
    stack = port_stack_bytes();
    facts[1] = rai_receiver_pin(&receiver);
    facts[2] = rai_receiver_state(&receiver, &facts[3]);
    report.size = (uint32_t)sizeof report;
    if (status == RAI_STATUS_OK) {
        status = rai_receiver_report(&receiver, &report);
    }
    answer(kind, text.lost == 0 ? status : RAI_STATUS_SHORT, stack, sizeof facts + sizeof report + text.length);
    port_write(facts, sizeof facts);
    port_write((const uint8_t *)&report, sizeof report);
    port_write(sentences, text.length);
}

static void explain_receiver(void)
{
    static rai_accuracy_t accuracy;
    static rai_velocity_t velocity;
    static rai_counter_t counters[256];
    size_t count = 0, counted = 0;
    rai_status_t status;
    uint32_t stack;
    accuracy.size = (uint32_t)sizeof accuracy;
    velocity.size = (uint32_t)sizeof velocity;
    port_paint_stack();
    status = rai_receiver_accuracy(&receiver, &accuracy);
    if (status == RAI_STATUS_OK) {
        status = rai_receiver_velocity(&receiver, &velocity);
    }
    if (status == RAI_STATUS_OK) {
        status = rai_receiver_residuals(&receiver, residuals, RAI_MAX_SATELLITES, &count);
    }
    while (counted < sizeof counters / sizeof counters[0]) {
        counters[counted].size = (uint32_t)sizeof counters[0];
        if (rai_receiver_counter(&receiver, counted, &counters[counted]) != RAI_STATUS_OK) {
            break;
        }
        counted++;
    }
    stack = port_stack_bytes();
    answer('a', status, stack,
           sizeof accuracy + sizeof velocity + count * sizeof residuals[0] + counted * sizeof counters[0]);
    port_write((const uint8_t *)&accuracy, sizeof accuracy);
    port_write((const uint8_t *)&velocity, sizeof velocity);
    port_write((const uint8_t *)residuals, count * sizeof residuals[0]);
    port_write((const uint8_t *)counters, counted * sizeof counters[0]);
}
#endif

#ifdef __cplusplus
extern "C"
#endif
    int program(void);

int program(void)
{
    uint8_t head[5];
    if (!port_open() || rai_abi_version() != RAI_ABI_VERSION) {
        return 1;
    }
    while (port_read(head, sizeof head) == sizeof head) {
        uint32_t length = length_at(&head[1]);
        if (length > MOST || port_read(payload, length) != length) {
            return 1;
        }
        switch (head[0]) {
        case 's': sizes(); break;
        case 'p': prepare(); break;
        case 'm': judge(length); break;
        case 'f': forget(); break;
        case 'n': explain(); break;
#ifndef MONITOR_ALONE
        case 'i': start(); break;
        case 'g':
        case 't':
        case 'k':
        case 'c': hear(head[0], length); break;
        case 'a': explain_receiver(); break;
#endif
        default: return 1;
        }
    }
    port_exit(0);
    return 0;
}
