/* Tells the service manager that the daemon lives while its main thread waits for the disk
 * (disk_wait.h). A thread of its own does this, and nothing else.
 *
 *   STARTING, STOPPING   EXTEND_TIMEOUT_USEC=: the start or the end may take longer
 *   RUNNING              WATCHDOG=1, as the main thread itself would send it
 *
 * It does so only while such a wait lasts, and for at most limit_ns since the last report of the
 * main thread itself. So the service manager still notices a main thread that hangs anywhere else,
 * or a disk that never answers. */
#ifndef ISO_FIRMWARE_DAEMON_LIFE_SIGN_H
#define ISO_FIRMWARE_DAEMON_LIFE_SIGN_H

#include <stdbool.h>
#include <stdint.h>

enum iso_life_phase { ISO_LIFE_STARTING = 0, ISO_LIFE_RUNNING, ISO_LIFE_STOPPING };

enum { ISO_LIFE_SIGN_LIMIT_S = 300 };

struct iso_life_sign_options {
    int64_t tick_ns;  /* interval of the checks, above 0 */
    int64_t limit_ns; /* for how long it may report for the main thread */
    bool watchdog;    /* the service manager expects WATCHDOG=1 */
    /* Sends a text to the service manager; called by the thread. REQUIRED */
    void (*send)(void *context, const char *text);
    void *context;
};

struct iso_life_sign;

/* Starts the thread, in the phase STARTING. It watches the waits of the calling thread. -ENOMEM,
 * -EAGAIN: no thread can be had. */
int iso_life_sign_new(const struct iso_life_sign_options *options, struct iso_life_sign **out)
    __attribute__((warn_unused_result));

/* Ends the thread. NULL is fine, here and below. */
void iso_life_sign_free(struct iso_life_sign *sign);

/* Begins another phase; limit_ns counts again from now. */
void iso_life_sign_enter(struct iso_life_sign *sign, enum iso_life_phase phase);

/* Reports that the main thread has just reported to the service manager by itself. */
void iso_life_sign_renew(struct iso_life_sign *sign);

#endif
