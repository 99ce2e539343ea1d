/* SIGTERM and SIGINT end an event loop. There is one daemon in a process. */
#ifndef ISO_FIRMWARE_DAEMON_QUIT_SIGNAL_H
#define ISO_FIRMWARE_DAEMON_QUIT_SIGNAL_H

#include <stdbool.h>
#include <systemd/sd-event.h>

/* From now on a signal wakes up the loop and sets *quit. Returns a negative errno on failure. */
int iso_quit_signal_catch(sd_event *event, bool *quit);

/* From now on the signals end the process again. */
void iso_quit_signal_release(void);

#endif
