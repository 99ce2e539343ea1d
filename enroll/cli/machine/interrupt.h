/* Records Ctrl-C (SIGINT) and SIGTERM, so that the program can undo its changes before it ends. */
#ifndef CLI_MACHINE_INTERRUPT_H
#define CLI_MACHINE_INTERRUPT_H

#include <stdbool.h>

/* From now on both signals are recorded instead of ending the program. */
void cli_interrupt_catch(void);

/* Whether one of these signals has come since then. Waits check this a few times a second. */
bool cli_interrupted(void);

/* Forgets a signal that has come, so that the work after an interrupt can wait again. */
void cli_interrupt_forget(void);

#endif
