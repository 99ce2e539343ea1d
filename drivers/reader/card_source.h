/* A reader of cards and keys, whatever it is connected to. wiegand_in.h
 * and osdp_reader_port.h are two. */
#ifndef ISO_DRIVERS_READER_CARD_SOURCE_H
#define ISO_DRIVERS_READER_CARD_SOURCE_H

#include <stdbool.h>

#include "core/base/fault.h"
#include "drivers/reader/wiegand_frame.h"

/* The first three are REQUIRED unless `take` is NULL, which means that there is no reader. */
struct iso_card_source {
    /* Takes the oldest event; false: there is none. */
    bool (*take)(void *context, struct iso_reader_event *out);
    /* Copies why the reader does not work; "" while it does. */
    void (*fault)(void *context, struct iso_fault *out);
    /* The descriptor that polls readable while there is an event, or the fault has changed. */
    int (*fd)(void *context);
    /* Shows at the reader whether somebody is let in; NULL: it cannot. */
    void (*show)(void *context, bool allow);
    void *context;
};

#endif
