/* The event loop of a program that runs as a service. */
#ifndef ISO_DRIVERS_PROCESS_SERVICE_LOOP_H
#define ISO_DRIVERS_PROCESS_SERVICE_LOOP_H

#include <systemd/sd-event.h>

/* Opens the default loop of the calling thread. SIGTERM and SIGINT end it; both are blocked from
 * now on. SIGPIPE is ignored. The loop feeds the watchdog of the service manager, if there is one.
 * The caller unreferences *out, also after an error if it is not NULL. A negative errno. */
int iso_service_loop_open(sd_event **out) __attribute__((warn_unused_result));

#endif
