#include "firmware/keys/stack_wipe.h"

#include <sodium.h>

/* Deeper than the handlers of calls and the writing of records go, with their libraries; small
 * enough for a stack of 256 kB. */
enum { STACK_BYTES = 96 * 1024 };

void iso_stack_wipe(void)
{
    sodium_stackzero(STACK_BYTES);
}
