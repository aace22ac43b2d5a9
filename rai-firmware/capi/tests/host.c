/* The test program's machine: a host. */
#include <stdio.h>
#include <stdlib.h>

#include "port.h"

static FILE *calls, *answers;

int port_open(void)
{
    calls = fopen("calls.bin", "rb");
    answers = fopen("answers.bin", "wb");
    return calls != NULL && answers != NULL;
}

size_t port_read(uint8_t *bytes, size_t count)
{
    return fread(bytes, 1, count, calls);
}

void port_write(const uint8_t *bytes, size_t count)
{
    if (fwrite(bytes, 1, count, answers) != count) {
        exit(3);
    }
}

void port_paint_stack(void)
{
}

uint32_t port_stack_bytes(void)
{
    return 0;
}

void port_exit(int code)
{
    fclose(calls);
    if (fclose(answers) != 0) {
        exit(3);
    }
    exit(code);
}

int program(void);

int main(void)
{
    return program();
}
