/* A device of OSDP on a serial line. It has a thread of its own, with the door's real-time priority
 * where that is permitted (RLIMIT_RTPRIO), because a reply is due within 200 ms, and a frame of the
 * sensor may take longer. A reply that would come later is not sent: the panel repeats its frame by
 * then, and both would be on the line at once.
 *
 * If the line is gone (an adapter was unplugged), the thread tries to open it again every second.
 */
#ifndef ISO_DRIVERS_DOOR_OSDP_OSDP_PORT_H
#define ISO_DRIVERS_DOOR_OSDP_OSDP_PORT_H

#include "core/base/clock.h"
#include "core/base/fault.h"
#include "drivers/door/osdp/osdp_peripheral.h"

#define ISO_OSDP_REPLY_NS INT64_C(200000000)

enum { ISO_OSDP_PRIORITY = 20 }; /* of SCHED_FIFO */

struct iso_osdp_port;

/* The state of a port. */
struct iso_osdp_port_status {
    struct iso_osdp_status device;
    bool realtime; /* the thread has SCHED_FIFO */
    bool line_gone;
    uint64_t late; /* replies that were not sent */
};

/* Opens the line and starts the thread. If the line cannot be opened for a reason that may pass
 * (-ENODEV, -EACCES, -EBUSY, -EIO), *absent says why, the line counts as gone, and the thread tries
 * again; the text of *absent is "" otherwise. `setup` is copied; its member `random` is not used,
 * because the port takes random numbers from the kernel. setup->store is called by the port's
 * thread, which holds the port's mutex then: it must not call the port, and it may take the time of
 * a write to the disk. setup->context must outlive the port. `clock` must be one whose time goes on
 * by itself.
 *
 * Other errors of iso_osdp_serial_open; -EINVAL a setup that is not possible, -ENOMEM, -EAGAIN no
 * thread can be started. */
int iso_osdp_port_new(const char *path, const struct iso_osdp_setup *setup,
                      const struct iso_clock *clock, struct iso_osdp_port **out,
                      struct iso_fault *absent, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Ends the thread and closes the line. NULL is fine. */
void iso_osdp_port_free(struct iso_osdp_port *port);

/* A file descriptor that is readable after the state has changed (the panel came or fell silent,
 * the channel was opened or closed, a key was set, something else is to be shown, an event was
 * lost). iso_osdp_port_look makes it unreadable again. It belongs to the port. */
int iso_osdp_port_event_fd(const struct iso_osdp_port *port);

/* Copies the state. */
void iso_osdp_port_look(struct iso_osdp_port *port, struct iso_osdp_port_status *status);

/* As the functions of osdp_peripheral.h; they may be called from any thread. */
int iso_osdp_port_card(struct iso_osdp_port *port, const uint8_t *bytes, size_t bits)
    __attribute__((warn_unused_result));
int iso_osdp_port_digits(struct iso_osdp_port *port, const char *digits)
    __attribute__((warn_unused_result));
void iso_osdp_port_set_tamper(struct iso_osdp_port *port, bool tamper);
void iso_osdp_port_set_reader(struct iso_osdp_port *port, uint8_t reader);
void iso_osdp_port_set_input(struct iso_osdp_port *port, unsigned input, bool active);
void iso_osdp_port_install(struct iso_osdp_port *port);

#endif
