/* The virtual camera as a driver of the OpenNI2 runtime (driver_abi.h). The environment variable
 * ISOTHERM_BENCH names its bench; without it the driver has no device. The runtime loads a driver
 * once in a process, so the driver is a static object. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/openni2/driver_abi.h"
#include "tests/openni2/virtual_camera.h"
#include "tests/openni2/virtual_stream.h"

enum { STREAMS = 2, LOG_ERROR = 3 };

static const char bench_variable[] = "ISOTHERM_BENCH";
static const char serial[] = "BENCH-1";

static struct driver {
    struct OniDriverServices *services;
    sim_oni_device_event *connected, *disconnected;
    sim_oni_device_state *state_changed;
    void *cookie;
    struct sim_virtual_camera *camera; /* NULL: no bench */
    OniDeviceInfo info;
    struct sim_virtual_stream streams[STREAMS];
    OniSensorInfo sensors[STREAMS];
    pthread_mutex_t lock;    /* of the streams' state */
    pthread_mutex_t exposed; /* held while a frame is passed on: stopping waits for it */
} driver = {.lock = PTHREAD_MUTEX_INITIALIZER, .exposed = PTHREAD_MUTEX_INITIALIZER};

/* ---- events of the camera ---- */

static void on_plugged(void *context, bool in)
{
    (void)context;
    (in ? driver.connected : driver.disconnected)(&driver.info, driver.cookie);
}

static void on_frame(void *context, const struct iso_frame *frame, int index, uint64_t t_us)
{
    (void)context;
    pthread_mutex_lock(&driver.exposed);
    for (int i = 0; i < STREAMS; i++) {
        sim_virtual_stream_deliver(&driver.streams[i], frame, index, t_us);
    }
    pthread_mutex_unlock(&driver.exposed);
}

static void on_fault(void *context, const char *text)
{
    (void)context;
    driver.services->log(driver.services->driverServices, LOG_ERROR, __FILE__, __LINE__,
                         "IsothermCamera", text);
    driver.state_changed(&driver.info, ONI_DEVICE_STATE_ERROR, driver.cookie);
}

/* ---- driver ---- */

void oniDriverCreate(struct OniDriverServices *services)
{
    driver.services = services;
}

void oniDriverDestroy(void)
{
    sim_virtual_camera_free(driver.camera);
    driver.camera = NULL;
}

static void describe_device(const char *bench)
{
    const struct iso_recording_meta *meta = sim_virtual_camera_meta(driver.camera);
    memset(&driver.info, 0, sizeof driver.info);
    (void)snprintf(driver.info.uri, sizeof driver.info.uri, "bench:%s", bench);
    (void)snprintf(driver.info.vendor, sizeof driver.info.vendor, "Isotherm");
    (void)snprintf(driver.info.name, sizeof driver.info.name, "%s", meta->sensor);
    for (int i = 0; i < STREAMS; i++) {
        struct sim_virtual_stream *stream = &driver.streams[i];
        sim_virtual_stream_init(stream, i == 0 ? ONI_SENSOR_DEPTH : ONI_SENSOR_IR, meta,
                                &driver.lock);
        driver.sensors[i] = (OniSensorInfo){stream->type, stream->n_modes, stream->modes};
    }
}

OniStatus oniDriverInitialize(sim_oni_device_event *connected, sim_oni_device_event *disconnected,
                              sim_oni_device_state *state_changed, void *cookie)
{
    const struct sim_virtual_camera_events events = {on_plugged, on_frame, on_fault, NULL};
    const char *bench = getenv(bench_variable);
    struct iso_fault fault = {.text = ""};
    driver.connected = connected;
    driver.disconnected = disconnected;
    driver.state_changed = state_changed;
    driver.cookie = cookie;
    if (!bench) {
        return ONI_STATUS_OK;
    }
    if (sim_virtual_camera_new(bench, &events, &driver.camera, &fault)) {
        driver.services->log(driver.services->driverServices, LOG_ERROR, __FILE__, __LINE__,
                             "IsothermCamera", fault.text);
        return ONI_STATUS_ERROR;
    }
    describe_device(bench);
    return sim_virtual_camera_run(driver.camera) ? ONI_STATUS_ERROR : ONI_STATUS_OK;
}

OniStatus oniDriverTryDevice(const char *uri)
{
    (void)uri; /* the driver has already reported the camera if it is plugged in */
    return ONI_STATUS_ERROR;
}

void *oniDriverEnableFrameSync(void **streams, int n_streams)
{
    (void)streams;
    return n_streams > 0 ? &driver : NULL; /* depth and infrared are of one exposure anyway */
}

void oniDriverDisableFrameSync(void *group)
{
    (void)group;
}

/* ---- device ---- */

void *oniDriverDeviceOpen(const char *uri, const char *mode)
{
    (void)mode;
    return driver.camera && strcmp(uri, driver.info.uri) == 0 ? &driver : NULL;
}

void oniDriverDeviceClose(void *device)
{
    (void)device;
}

OniStatus oniDriverDeviceGetSensorInfoList(void *device, OniSensorInfo **sensors, int *n_sensors)
{
    (void)device;
    *sensors = driver.sensors;
    *n_sensors = STREAMS;
    return ONI_STATUS_OK;
}

void *oniDriverDeviceCreateStream(void *device, OniSensorType type)
{
    struct sim_virtual_stream *found = NULL;
    (void)device;
    pthread_mutex_lock(&driver.lock);
    for (int i = 0; i < STREAMS; i++) {
        if (driver.streams[i].type == type && !driver.streams[i].created) {
            found = &driver.streams[i];
            found->created = true;
        }
    }
    pthread_mutex_unlock(&driver.lock);
    return found;
}

void oniDriverDeviceDestroyStream(void *device, void *stream)
{
    struct sim_virtual_stream *destroyed = stream;
    (void)device;
    oniDriverStreamStop(stream);
    sim_virtual_stream_init(destroyed, destroyed->type, destroyed->meta, destroyed->lock);
}

OniStatus oniDriverDeviceSetProperty(void *device, int property, const void *data, int size)
{
    (void)device;
    (void)property;
    (void)data;
    (void)size;
    return ONI_STATUS_NOT_SUPPORTED;
}

OniStatus oniDriverDeviceGetProperty(void *device, int property, void *data, int *size)
{
    (void)device;
    if (property != ONI_DEVICE_PROPERTY_SERIAL_NUMBER) {
        return ONI_STATUS_NOT_SUPPORTED;
    }
    if (*size < (int)sizeof serial) {
        return ONI_STATUS_BAD_PARAMETER;
    }
    memcpy(data, serial, sizeof serial);
    *size = (int)sizeof serial;
    return ONI_STATUS_OK;
}

OniBool oniDriverDeviceIsPropertySupported(void *device, int property)
{
    (void)device;
    return property == ONI_DEVICE_PROPERTY_SERIAL_NUMBER;
}

void oniDriverDeviceSetPropertyChangedCallback(void *device, sim_oni_property_changed *handler,
                                               void *cookie)
{
    (void)device; /* no property changes by itself */
    (void)handler;
    (void)cookie;
}

void oniDriverDeviceNotifyAllProperties(void *device)
{
    (void)device;
}

OniStatus oniDriverDeviceInvoke(void *device, int command, void *data, int size)
{
    (void)device;
    (void)command;
    (void)data;
    (void)size;
    return ONI_STATUS_NOT_SUPPORTED;
}

OniBool oniDriverDeviceIsCommandSupported(void *device, int command)
{
    (void)device;
    (void)command;
    return FALSE;
}

OniStatus oniDriverDeviceTryManualTrigger(void *device)
{
    (void)device;
    return ONI_STATUS_OK;
}

OniBool oniDriverDeviceIsImageRegistrationModeSupported(void *device, OniImageRegistrationMode mode)
{
    (void)device;
    return mode == ONI_IMAGE_REGISTRATION_OFF;
}

/* ---- stream ---- */

void oniDriverStreamSetServices(void *stream, struct OniStreamServices *services)
{
    pthread_mutex_lock(&driver.lock);
    ((struct sim_virtual_stream *)stream)->services = services;
    pthread_mutex_unlock(&driver.lock);
}

OniStatus oniDriverStreamSetProperty(void *stream, int property, const void *data, int size)
{
    return sim_virtual_stream_set(stream, property, data, size);
}

OniStatus oniDriverStreamGetProperty(void *stream, int property, void *data, int *size)
{
    return sim_virtual_stream_get(stream, property, data, size);
}

OniBool oniDriverStreamIsPropertySupported(void *stream, int property)
{
    (void)stream;
    return sim_virtual_stream_has(property);
}

void oniDriverStreamSetPropertyChangedCallback(void *stream, sim_oni_property_changed *handler,
                                               void *cookie)
{
    (void)stream; /* no property changes by itself */
    (void)handler;
    (void)cookie;
}

void oniDriverStreamNotifyAllProperties(void *stream)
{
    (void)stream;
}

OniStatus oniDriverStreamInvoke(void *stream, int command, void *data, int size)
{
    (void)stream;
    (void)command;
    (void)data;
    (void)size;
    return ONI_STATUS_NOT_SUPPORTED;
}

OniBool oniDriverStreamIsCommandSupported(void *stream, int command)
{
    (void)stream;
    (void)command;
    return FALSE;
}

static void set_started(struct sim_virtual_stream *stream, bool started)
{
    bool any = false;
    pthread_mutex_lock(&driver.lock);
    stream->started = started;
    for (int i = 0; i < STREAMS; i++) {
        any |= driver.streams[i].started;
    }
    pthread_mutex_unlock(&driver.lock);
    sim_virtual_camera_stream(driver.camera, any);
}

OniStatus oniDriverStreamStart(void *stream)
{
    set_started(stream, true);
    return ONI_STATUS_OK;
}

void oniDriverStreamStop(void *stream)
{
    set_started(stream, false);
    pthread_mutex_lock(&driver.exposed); /* no frame arrives after this call */
    pthread_mutex_unlock(&driver.exposed);
}

int oniDriverStreamGetRequiredFrameSize(void *stream)
{
    const struct iso_camera *camera = &((struct sim_virtual_stream *)stream)->meta->camera;
    return camera->width_px * camera->height_px * (int)sizeof(uint16_t);
}

void oniDriverStreamSetNewFrameCallback(void *stream, sim_oni_new_frame *handler, void *cookie)
{
    struct sim_virtual_stream *of = stream;
    pthread_mutex_lock(&driver.lock);
    of->new_frame = handler;
    of->new_frame_cookie = cookie;
    pthread_mutex_unlock(&driver.lock);
}

OniStatus oniDriverStreamConvertDepthToColorCoordinates(void *depth, void *color, int x, int y,
                                                        OniDepthPixel z, int *color_x, int *color_y)
{
    (void)depth;
    (void)color;
    (void)x;
    (void)y;
    (void)z;
    (void)color_x;
    (void)color_y;
    return ONI_STATUS_NOT_SUPPORTED; /* it has no colour camera */
}
