/* A card reader or keypad with Wiegand lines D0 and D1, on two inputs of a GPIO chip (gpio_line.h).
 *
 * Pulses come every 2 ms and are 50 us long, and the kernel keeps 16 edges of a line, so each
 * reader has a thread of its own, with SCHED_FIFO where that is permitted. It waits for edges and
 * does nothing else. Cards and keys wait in a queue of ISO_WIEGAND_IN_EVENTS; further ones are
 * dropped, because nobody means a card that was shown long ago. If the chip is gone, the thread
 * tries to open the lines again every second. */
#ifndef ISO_DRIVERS_READER_WIEGAND_IN_H
#define ISO_DRIVERS_READER_WIEGAND_IN_H

#include <stdbool.h>

#include "core/base/fault.h"
#include "drivers/door/gpio_line.h"
#include "drivers/reader/wiegand_frame.h"

enum { ISO_WIEGAND_IN_EVENTS = 16 };

struct iso_wiegand_in;

/* Opens the lines D0 and D1 and starts the thread. Lines that cannot be opened now (-ENODEV,
 * -EBUSY, -EACCES, -EIO) are no error here: *fault then says why, and they are tried again.
 * -EAGAIN, -ENOMEM no thread can be had. */
int iso_wiegand_in_new(const struct iso_gpio_spec lines[2], struct iso_wiegand_in **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Ends the thread and releases the lines. NULL is fine. */
void iso_wiegand_in_free(struct iso_wiegand_in *reader);

/* The descriptor that polls readable while the queue is not empty, or the fault has changed. Owned
 * by the reader. */
int iso_wiegand_in_fd(const struct iso_wiegand_in *reader);

/* Takes the oldest event; false: there is none. A frame that was damaged is an event, too. */
bool iso_wiegand_in_take(struct iso_wiegand_in *reader, struct iso_reader_event *out);

/* Copies why the lines do not work; "" while they do. */
void iso_wiegand_in_fault(struct iso_wiegand_in *reader, struct iso_fault *out);

#endif
