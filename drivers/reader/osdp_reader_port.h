/* A reader of OSDP on a serial line (osdp_reader.h). It has a thread of its own, with SCHED_FIFO
 * where that is permitted, which asks the reader every 50 ms. If the line is gone (an adapter was
 * unplugged), the thread tries to open it again every second. */
#ifndef ISO_DRIVERS_READER_OSDP_READER_PORT_H
#define ISO_DRIVERS_READER_OSDP_READER_PORT_H

#include "core/base/clock.h"
#include "core/base/fault.h"
#include "drivers/reader/osdp_reader.h"

struct iso_osdp_reader_port;

/* Opens the line and starts the thread. `setup` is copied; its member `random` is not used, because
 * the port takes random numbers from the kernel. `clock` must be one whose time goes on by itself.
 * A line that cannot be opened now is no error: *fault then says why, with the codes of
 * iso_osdp_serial_open, and it is tried again. -EINVAL a setup that is not possible; -EAGAIN,
 * -ENOMEM no thread can be had. */
int iso_osdp_reader_port_new(const char *path, const struct iso_osdp_reader_setup *setup,
                             const struct iso_clock *clock, struct iso_osdp_reader_port **out,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

/* Ends the thread, closes the line and wipes the key. NULL is fine. */
void iso_osdp_reader_port_free(struct iso_osdp_reader_port *port);

/* The descriptor that polls readable while an event waits, or the fault has changed. Owned by the
 * port. */
int iso_osdp_reader_port_fd(const struct iso_osdp_reader_port *port);

/* Takes the oldest event; false: there is none. */
bool iso_osdp_reader_port_take(struct iso_osdp_reader_port *port, struct iso_reader_event *out);

/* Copies why the reader does not work; "" while it does. A fault of the line has the code of
 * iso_osdp_serial_open, others have none. */
void iso_osdp_reader_port_fault(struct iso_osdp_reader_port *port, struct iso_fault *out);

/* As the functions of osdp_reader.h; they may be called from any thread. */
void iso_osdp_reader_port_show(struct iso_osdp_reader_port *port, bool allow);
void iso_osdp_reader_port_status(struct iso_osdp_reader_port *port,
                                 struct iso_osdp_reader_status *status);

#endif
