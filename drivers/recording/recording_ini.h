/* The text of a recording.ini. */
#ifndef SIM_RECORDING_RECORDING_INI_H
#define SIM_RECORDING_RECORDING_INI_H

#include <stdio.h>

#include "drivers/recording/recording.h"

/* Prints a description that iso_recording_meta_check accepts, so that iso_recording_meta_parse
 * reads back exactly the same values. -EIO if writing to the stream fails. */
int sim_recording_ini_print(FILE *stream, const struct iso_recording_meta *meta)
    __attribute__((warn_unused_result));

#endif
