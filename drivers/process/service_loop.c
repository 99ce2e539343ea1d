#include "drivers/process/service_loop.h"

#include <signal.h>

int iso_service_loop_open(sd_event **out)
{
    sigset_t signals;

    (void)signal(SIGPIPE, SIG_IGN);
    (void)sigemptyset(&signals);
    (void)sigaddset(&signals, SIGTERM);
    (void)sigaddset(&signals, SIGINT);
    (void)sigprocmask(SIG_BLOCK, &signals, NULL);
    int r = sd_event_default(out);
    r = r < 0 ? r : sd_event_add_signal(*out, NULL, SIGTERM, NULL, NULL);
    r = r < 0 ? r : sd_event_add_signal(*out, NULL, SIGINT, NULL, NULL);
    return r < 0 ? r : sd_event_set_watchdog(*out, 1);
}
