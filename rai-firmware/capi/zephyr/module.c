/* Where a panic of the library would end in Zephyr: none is reachable, and if one were, the kernel should know. */
#include <zephyr/kernel.h>

void rai_panic(void)
{
    k_panic();
}
