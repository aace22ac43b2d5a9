/* The bytes of a GNSS receiver in, sentences and one pin out: high while the position may be used.
 *
 * The interrupt of the UART stores each byte with its time of arrival. The main thread judges. Ten
 * times a second it tells the module the time, so that the pin falls within the time to alert if the line is silent.
 */
#include <zephyr/drivers/gpio.h>
#include <zephyr/drivers/uart.h>
#include <zephyr/kernel.h>

#include "rai.h"

/* Bytes that may wait while an epoch is judged and reported: 0.18 s of a line of 115,200 baud. */
#define QUEUE_LENGTH 2048
#define TICK_MS 100

/* A byte with its time of arrival, ms, without the upper half. */
struct arrival {
    uint32_t came_ms;
    uint8_t byte;
};

static const struct device *const gnss = DEVICE_DT_GET(DT_CHOSEN(rai_gnss));
static const struct device *const host = DEVICE_DT_GET(DT_CHOSEN(rai_host));
static const struct gpio_dt_spec pin = GPIO_DT_SPEC_GET(DT_PATH(zephyr_user), integrity_gpios);

K_MSGQ_DEFINE(arrivals, sizeof(struct arrival), QUEUE_LENGTH, 4);

static rai_receiver_t receiver;
static uint8_t sentences[4096];
static rai_text_t text = {.bytes = sentences, .capacity = sizeof sentences};

static void on_gnss(const struct device *port, void *unused)
{
    struct arrival next;

    ARG_UNUSED(unused);
    while (uart_irq_update(port) && uart_irq_rx_ready(port)) {
        next.came_ms = k_uptime_get_32();
        while (uart_fifo_read(port, &next.byte, 1) == 1) {
            /* A full queue loses the byte; the check of its frame then fails, and the frame is counted. */
            (void)k_msgq_put(&arrivals, &next, K_NO_WAIT);
        }
    }
}

/* The pin first, and then what may wait for the host. */
static void report(void)
{
    (void)gpio_pin_set_dt(&pin, rai_receiver_pin(&receiver) ? 1 : 0);
    for (size_t i = 0; i < text.length; i++) {
        uart_poll_out(host, text.bytes[i]);
    }
    text.length = 0;
}

int main(void)
{
    struct arrival next;
    uint64_t ticked_ms = 0;

    /* The pin is low before anything else can fail. */
    if (!gpio_is_ready_dt(&pin) || gpio_pin_configure_dt(&pin, GPIO_OUTPUT_INACTIVE) != 0) {
        return 1;
    }
    if (!device_is_ready(gnss) || !device_is_ready(host)) {
        return 1;
    }
    if (rai_receiver_init(&receiver, sizeof receiver, &text) != RAI_STATUS_OK) {
        return 1;
    }
    report();
    if (uart_irq_callback_user_data_set(gnss, on_gnss, NULL) != 0) {
        return 1;
    }
    uart_irq_rx_enable(gnss);
    for (;;) {
        bool has_byte = k_msgq_get(&arrivals, &next, K_MSEC(TICK_MS)) == 0;
        uint64_t now_ms = (uint64_t)k_uptime_get();

        if (has_byte) {
            uint64_t came_ms = now_ms - (uint32_t)((uint32_t)now_ms - next.came_ms);
            (void)rai_receiver_gnss(&receiver, &next.byte, 1, came_ms, &text, NULL);
        }
        /* Noise on the line must not stop the time. */
        if (now_ms - ticked_ms >= TICK_MS) {
            ticked_ms = now_ms;
            (void)rai_receiver_tick(&receiver, now_ms, &text);
        }
        report();
    }
}
