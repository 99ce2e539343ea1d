/* The interface between the OpenNI2 runtime and a driver, in C. Driver/OniDriverAPI.h defines it
 * for C++ only: there a device and a stream are classes, here they are pointers that the runtime
 * passes back. The runtime finds the functions by name (dlsym) and refuses a library that lacks one
 * of them. */
#ifndef SIM_OPENNI2_DRIVER_ABI_H
#define SIM_OPENNI2_DRIVER_ABI_H

#include <stdarg.h>

/* OniCTypes.h uses the tags of these three as type names, which is valid in C++ only. */
typedef struct _OniDevice _OniDevice;
typedef struct _OniStream _OniStream;
typedef struct _OniRecorder _OniRecorder;

#include <Driver/OniDriverTypes.h>
#include <OniCProperties.h>

typedef void sim_oni_device_event(const OniDeviceInfo *info, void *cookie);
typedef void sim_oni_device_state(const OniDeviceInfo *info, int state, void *cookie);
typedef void sim_oni_new_frame(void *stream, OniFrame *frame, void *cookie);
typedef void sim_oni_property_changed(void *sender, int property, const void *data, int size,
                                      void *cookie);

/* The driver. */
ONI_API_EXPORT void oniDriverCreate(struct OniDriverServices *services);
ONI_API_EXPORT void oniDriverDestroy(void);
ONI_API_EXPORT OniStatus oniDriverInitialize(sim_oni_device_event *connected,
                                             sim_oni_device_event *disconnected,
                                             sim_oni_device_state *state_changed, void *cookie);
ONI_API_EXPORT OniStatus oniDriverTryDevice(const char *uri);
ONI_API_EXPORT void *oniDriverEnableFrameSync(void **streams, int n_streams);
ONI_API_EXPORT void oniDriverDisableFrameSync(void *group);

/* A device. */
ONI_API_EXPORT void *oniDriverDeviceOpen(const char *uri, const char *mode);
ONI_API_EXPORT void oniDriverDeviceClose(void *device);
ONI_API_EXPORT OniStatus oniDriverDeviceGetSensorInfoList(void *device, OniSensorInfo **sensors,
                                                          int *n_sensors);
ONI_API_EXPORT void *oniDriverDeviceCreateStream(void *device, OniSensorType type);
ONI_API_EXPORT void oniDriverDeviceDestroyStream(void *device, void *stream);
ONI_API_EXPORT OniStatus oniDriverDeviceSetProperty(void *device, int property, const void *data,
                                                    int size);
ONI_API_EXPORT OniStatus oniDriverDeviceGetProperty(void *device, int property, void *data,
                                                    int *size);
ONI_API_EXPORT OniBool oniDriverDeviceIsPropertySupported(void *device, int property);
ONI_API_EXPORT void oniDriverDeviceSetPropertyChangedCallback(void *device,
                                                              sim_oni_property_changed *handler,
                                                              void *cookie);
ONI_API_EXPORT void oniDriverDeviceNotifyAllProperties(void *device);
ONI_API_EXPORT OniStatus oniDriverDeviceInvoke(void *device, int command, void *data, int size);
ONI_API_EXPORT OniBool oniDriverDeviceIsCommandSupported(void *device, int command);
ONI_API_EXPORT OniStatus oniDriverDeviceTryManualTrigger(void *device);
ONI_API_EXPORT OniBool
oniDriverDeviceIsImageRegistrationModeSupported(void *device, OniImageRegistrationMode mode);

/* A stream. */
ONI_API_EXPORT void oniDriverStreamSetServices(void *stream, struct OniStreamServices *services);
ONI_API_EXPORT OniStatus oniDriverStreamSetProperty(void *stream, int property, const void *data,
                                                    int size);
ONI_API_EXPORT OniStatus oniDriverStreamGetProperty(void *stream, int property, void *data,
                                                    int *size);
ONI_API_EXPORT OniBool oniDriverStreamIsPropertySupported(void *stream, int property);
ONI_API_EXPORT void oniDriverStreamSetPropertyChangedCallback(void *stream,
                                                              sim_oni_property_changed *handler,
                                                              void *cookie);
ONI_API_EXPORT void oniDriverStreamNotifyAllProperties(void *stream);
ONI_API_EXPORT OniStatus oniDriverStreamInvoke(void *stream, int command, void *data, int size);
ONI_API_EXPORT OniBool oniDriverStreamIsCommandSupported(void *stream, int command);
ONI_API_EXPORT OniStatus oniDriverStreamStart(void *stream);
ONI_API_EXPORT void oniDriverStreamStop(void *stream);
ONI_API_EXPORT int oniDriverStreamGetRequiredFrameSize(void *stream);
ONI_API_EXPORT void oniDriverStreamSetNewFrameCallback(void *stream, sim_oni_new_frame *handler,
                                                       void *cookie);
ONI_API_EXPORT OniStatus oniDriverStreamConvertDepthToColorCoordinates(void *depth, void *color,
                                                                       int x, int y,
                                                                       OniDepthPixel z,
                                                                       int *color_x, int *color_y);

#endif
