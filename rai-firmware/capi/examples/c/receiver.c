/* The whole module on a host: bytes of a receiver on standard input, sentences on standard output.
 *
 * On a microcontroller the loop is the same. A UART replaces standard input, a clock replaces the
 * count of bytes, and a pin is set where this program counts.
 */
#include <stdio.h>

#include "rai.h"

/* Memory of the receiver and of its sentences, static, so that it needs no heap and no stack. */
static rai_receiver_t receiver;
static uint8_t sentences[4096];

static void send_on(rai_text_t *text)
{
    fwrite(text->bytes, 1, text->length, stdout);
    text->length = 0;
}

int main(void)
{
    static uint8_t chunk[256];
    static rai_text_t text;
    uint64_t came = 0;
    unsigned long epochs = 0, usable = 0;
    size_t count;

    text.bytes = sentences;
    text.capacity = sizeof sentences;
    if (rai_receiver_init(&receiver, sizeof receiver, &text) != RAI_STATUS_OK) {
        return 1;
    }
    send_on(&text);

    while ((count = fread(chunk, 1, sizeof chunk, stdin)) > 0) {
        size_t i;
        for (i = 0; i < count; i++) {
            uint8_t judged = 0;
            /* A line of 115,200 baud carries 11,520 bytes per second. */
            uint64_t now_ms = ++came * 1000u / 11520u;
            rai_status_t status = rai_receiver_gnss(&receiver, &chunk[i], 1, now_ms, &text, &judged);
            if (status != RAI_STATUS_OK) {
                fprintf(stderr, "refused: %s\n", rai_status_text(status));
                return 1;
            }
            if (judged) {
                epochs++;
                usable += rai_receiver_pin(&receiver);
            }
            send_on(&text);
        }
    }
    fprintf(stderr, "%lu epochs, pin high after %lu\n", epochs, usable);
    return text.lost == 0 ? 0 : 2;
}
