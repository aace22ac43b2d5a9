/* The part of Zephyr's kernel that the sample uses, as functions of a test: no Zephyr. */
#ifndef STUB_KERNEL_H
#define STUB_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ARG_UNUSED(x) (void)(x)
#define K_NO_WAIT 0
#define K_MSEC(ms) (ms)

struct k_msgq {
    size_t size, capacity, count;
    uint8_t bytes[16];
};
/* The queue of the stub holds one message, because the reader runs after each byte. */
#define K_MSGQ_DEFINE(name, message, length, align) static struct k_msgq name = {message, length, 0, {0}}

int k_msgq_put(struct k_msgq *queue, const void *message, int timeout_ms);
int k_msgq_get(struct k_msgq *queue, void *message, int timeout_ms);
int64_t k_uptime_get(void);
uint32_t k_uptime_get_32(void);

#endif
