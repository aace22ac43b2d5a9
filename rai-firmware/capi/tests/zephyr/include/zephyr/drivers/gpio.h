/* The part of Zephyr's GPIO interface that the sample uses. */
#ifndef STUB_GPIO_H
#define STUB_GPIO_H

#include <stdbool.h>
#include <stdint.h>

struct gpio_dt_spec {
    uint8_t pin;
};
#define GPIO_OUTPUT_INACTIVE 1
#define DT_PATH(node) node
#define GPIO_DT_SPEC_GET(node, property) {6}

bool gpio_is_ready_dt(const struct gpio_dt_spec *spec);
int gpio_pin_configure_dt(const struct gpio_dt_spec *spec, uint32_t flags);
int gpio_pin_set_dt(const struct gpio_dt_spec *spec, int value);

#endif
