#include "firmware/keys/stack_wipe.h"

#include <sodium.h>

/* More than the handlers of calls and the writing of records use, together with their libraries,
 * and little enough for a stack of 256 kB. */
enum { STACK_BYTES = 96 * 1024 };

void iso_stack_wipe(void)
{
    sodium_stackzero(STACK_BYTES);
}
