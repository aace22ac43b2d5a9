/* A board for the sample, on a host: standard input is the receiver's line of 115,200 baud, then 15 s of silence.
 *
 * Standard output has a line for each change of the pin, with the time in ms, and at the end the number of bytes that the
 * host port got.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <zephyr/drivers/gpio.h>
#include <zephyr/drivers/uart.h>
#include <zephyr/kernel.h>

#define SILENCE_MS 15000

const struct device stub_rai_gnss = {"gnss"}, stub_rai_host = {"host"};

static uart_irq_callback_user_data_t on_gnss;
static uint64_t bits, silent_ms, host_bytes;
static int byte = -1, level = -1;

int64_t k_uptime_get(void)
{
    return (int64_t)(bits * 1000 / 115200 + silent_ms);
}

uint32_t k_uptime_get_32(void)
{
    return (uint32_t)k_uptime_get();
}

int k_msgq_put(struct k_msgq *queue, const void *message, int timeout_ms)
{
    (void)timeout_ms;
    memcpy(queue->bytes, message, queue->size);
    queue->count = 1;
    return 0;
}

int k_msgq_get(struct k_msgq *queue, void *message, int timeout_ms)
{
    if ((byte = getchar()) != EOF) {
        bits += 10;
        on_gnss(&stub_rai_gnss, NULL);
    }
    if (queue->count == 1) {
        queue->count = 0;
        memcpy(message, queue->bytes, queue->size);
        return 0;
    }
    silent_ms += (uint64_t)timeout_ms;
    if (silent_ms > SILENCE_MS) {
        printf("host %llu\n", (unsigned long long)host_bytes);
        exit(0);
    }
    return -1;
}

bool device_is_ready(const struct device *device)
{
    return device != NULL;
}

int uart_irq_callback_user_data_set(const struct device *port, uart_irq_callback_user_data_t function, void *user_data)
{
    (void)user_data;
    on_gnss = function;
    return port == &stub_rai_gnss ? 0 : -1;
}

void uart_irq_rx_enable(const struct device *port)
{
    (void)port;
}

int uart_irq_update(const struct device *port)
{
    return port == &stub_rai_gnss;
}

int uart_irq_rx_ready(const struct device *port)
{
    (void)port;
    return byte != -1;
}

int uart_fifo_read(const struct device *port, uint8_t *bytes, int size)
{
    (void)port;
    if (byte == -1 || size < 1) {
        return 0;
    }
    bytes[0] = (uint8_t)byte;
    byte = -1;
    return 1;
}

void uart_poll_out(const struct device *port, unsigned char sent)
{
    (void)sent;
    host_bytes += port == &stub_rai_host;
}

bool gpio_is_ready_dt(const struct gpio_dt_spec *spec)
{
    return spec->pin == 6;
}

int gpio_pin_configure_dt(const struct gpio_dt_spec *spec, uint32_t flags)
{
    level = 0;
    printf("pin 0 at 0\n");
    return spec->pin == 6 && flags == GPIO_OUTPUT_INACTIVE ? 0 : -1;
}

int gpio_pin_set_dt(const struct gpio_dt_spec *spec, int value)
{
    if (spec->pin == 6 && value != level) {
        level = value;
        printf("pin %d at %lld\n", level, (long long)k_uptime_get());
    }
    return 0;
}
