/* The part of Zephyr's UART interface that the sample uses, and of its devicetree. */
#ifndef STUB_UART_H
#define STUB_UART_H

#include <stdbool.h>
#include <stdint.h>

struct device {
    const char *name;
};
extern const struct device stub_rai_gnss, stub_rai_host;
#define DT_CHOSEN(node) stub_##node
#define DEVICE_DT_GET(node) (&node)

typedef void (*uart_irq_callback_user_data_t)(const struct device *port, void *user_data);

bool device_is_ready(const struct device *device);
int uart_irq_callback_user_data_set(const struct device *port, uart_irq_callback_user_data_t function, void *user_data);
void uart_irq_rx_enable(const struct device *port);
int uart_irq_update(const struct device *port);
int uart_irq_rx_ready(const struct device *port);
int uart_fifo_read(const struct device *port, uint8_t *bytes, int size);
void uart_poll_out(const struct device *port, unsigned char byte);

#endif
