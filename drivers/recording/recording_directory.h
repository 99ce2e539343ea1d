/* The directory of an opened recording; for the sources of this folder. The text belongs to the
 * recording. */
#ifndef ISO_DRIVERS_RECORDING_RECORDING_DIRECTORY_H
#define ISO_DRIVERS_RECORDING_RECORDING_DIRECTORY_H

struct iso_recording;

const char *iso__recording_directory(const struct iso_recording *recording);

#endif
