/* The directory that a recording was opened in; for the sources of this folder. */
#ifndef ISO_DRIVERS_RECORDING_RECORDING_DIRECTORY_H
#define ISO_DRIVERS_RECORDING_RECORDING_DIRECTORY_H

struct iso_recording;

const char *iso__recording_directory(const struct iso_recording *recording);

#endif
