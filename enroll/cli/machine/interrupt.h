/* Notes that somebody pressed Ctrl-C (SIGINT) or that the program shall end (SIGTERM), so that what
 * was begun can be undone first. */
#ifndef CLI_MACHINE_INTERRUPT_H
#define CLI_MACHINE_INTERRUPT_H

#include <stdbool.h>

/* From here on both signals are noted instead of ending the program. */
void cli_interrupt_catch(void);

/* Whether one of them has come since then. Waits look at this a few times a second. */
bool cli_interrupted(void);

/* Forgets it: for what has to be done even so. */
void cli_interrupt_forget(void);

#endif
