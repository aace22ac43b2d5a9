/* What the test program needs of the machine it runs on: a host, or an emulated board. */
#ifndef PORT_H
#define PORT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Opens the files `calls.bin` and `answers.bin`; 0 where one of them cannot be opened. */
int port_open(void);

/* Reads so many bytes, or fewer where the file ends; says how many. */
size_t port_read(uint8_t *bytes, size_t count);

/* Writes bytes. */
void port_write(const uint8_t *bytes, size_t count);

/* Paints the stack below the caller. */
void port_paint_stack(void);

/* How deep the stack went below the caller since it was painted, bytes; 0 where that cannot be told. */
uint32_t port_stack_bytes(void);

/* Ends the program: 0 is success. */
void port_exit(int code);

#ifdef __cplusplus
}
#endif

#endif
