/* Converts the door's configuration to the options of its guard. */
#ifndef ISO_FIRMWARE_CONFIG_DOOR_OPTIONS_H
#define ISO_FIRMWARE_CONFIG_DOOR_OPTIONS_H

#include "drivers/base/times.h"
#include "drivers/door/door_io.h"
#include "firmware/config/config.h"
#include "firmware/door/door_guard.h"

/* Returns the options of a door guard that controls the lines `io`. The caller sets `record`.
 * `threaded` has the meaning of the field in door_guard.h. `times` and `io` are borrowed. */
struct iso_door_guard_options iso_door_options_of(const struct iso_config_door *config,
                                                  const struct iso_times *times,
                                                  struct iso_door_io *io, bool threaded);

#endif
