/* OpenNI2's C interface, which is C++ in one place: OniCTypes.h uses the tags of these three
 * structures as if they were types. For the sources of this folder. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_API_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_API_H

typedef struct _OniDevice _OniDevice;
typedef struct _OniStream _OniStream;
typedef struct _OniRecorder _OniRecorder;

#include <OniCAPI.h>

#endif
