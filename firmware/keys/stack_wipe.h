/* Wipes the data that functions have left on the stack: names, templates, texts. */
#ifndef ISO_FIRMWARE_KEYS_STACK_WIPE_H
#define ISO_FIRMWARE_KEYS_STACK_WIPE_H

/* Wipes 96 kB of this thread's stack below its caller. Call it where the stack is shallow: after
 * each turn of an event loop. It takes some microseconds. */
void iso_stack_wipe(void);

#endif
