#include "enroll/cli/machine/interrupt.h"

#include <signal.h>
#include <stddef.h>

static volatile sig_atomic_t interrupted;

static void note(int number)
{
    (void)number;
    interrupted = 1;
}

void cli_interrupt_catch(void)
{
    const struct sigaction action = {.sa_handler = note}; /* no SA_RESTART, so that waits end */

    interrupted = 0;
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
}

bool cli_interrupted(void)
{
    return interrupted != 0;
}

void cli_interrupt_forget(void)
{
    interrupted = 0;
}
