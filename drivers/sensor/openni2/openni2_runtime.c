#include "drivers/sensor/openni2/openni2_runtime.h"

#include <errno.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"

static const char owner[] = "sensor openni2";

/* ---- failures --------------------------------------------------------------- */

int iso__openni2_refuse(OniStatus status, const char *what, struct iso_fault *fault)
{
    char words[160];
    const int error = status == ONI_STATUS_NO_DEVICE ? -ENODEV : -EIO;
    (void)snprintf(words, sizeof words, "%s", oniGetExtendedError());
    for (char *c = words; *c; c++) {
        *c = *c < ' ' ? ' ' : *c;
    }
    for (size_t n = strlen(words); n > 0 && words[n - 1] == ' '; n--) {
        words[n - 1] = '\0';
    }
    return iso_fault_set_code(
        fault, error == -ENODEV ? ISO_FAULT_SENSOR_GONE : ISO_FAULT_SENSOR_FAILED, error,
        "%s: %s: %s", owner, what, words[0] ? words : "no reason given");
}

int iso__openni2_start_runtime(struct iso_fault *fault)
{
    const OniStatus status = oniInitialize(ONI_API_VERSION);
    return status == ONI_STATUS_OK
               ? 0
               : iso__openni2_refuse(status, "the runtime does not start", fault);
}

static atomic_bool staying;

void iso__openni2_stay(void)
{
    if (!atomic_exchange(&staying, true) && oniInitialize(ONI_API_VERSION) != ONI_STATUS_OK) {
        atomic_store(&staying, false);
    }
}

void iso__openni2_leave(void)
{
    if (atomic_exchange(&staying, false)) {
        oniShutdown();
    }
}

/* ---- finding a device ------------------------------------------------------- */

void iso__openni2_read_serial(OniDeviceHandle device, char serial[64])
{
    char text[ONI_MAX_STR] = "";
    int size = sizeof text - 1;
    serial[0] = '\0';
    if (oniDeviceIsPropertySupported(device, ONI_DEVICE_PROPERTY_SERIAL_NUMBER) &&
        oniDeviceGetProperty(device, ONI_DEVICE_PROPERTY_SERIAL_NUMBER, text, &size) ==
            ONI_STATUS_OK) {
        (void)snprintf(serial, 64, "%s", text);
    }
}

static bool has_serial(const OniDeviceInfo *info, const char *wanted)
{
    OniDeviceHandle device = NULL;
    char serial[64];
    if (oniDeviceOpen(info->uri, &device) != ONI_STATUS_OK) {
        return false;
    }
    iso__openni2_read_serial(device, serial);
    (void)oniDeviceClose(device);
    return strcmp(serial, wanted) == 0;
}

static const OniDeviceInfo *choose(const OniDeviceInfo *devices, int n, const char *wanted)
{
    for (int i = 0; i < n; i++) {
        if (!wanted || strcmp(devices[i].uri, wanted) == 0) {
            return &devices[i];
        }
    }
    for (int i = 0; i < n; i++) {
        if (has_serial(&devices[i], wanted)) {
            return &devices[i];
        }
    }
    return NULL;
}

static int none_such(const OniDeviceInfo *devices, int n, const char *wanted,
                     struct iso_fault *fault)
{
    char seen[160] = "";
    size_t used = 0;
    for (int i = 0; i < n && used < sizeof seen; i++) {
        const int length = snprintf(seen + used, sizeof seen - used, " %s", devices[i].uri);
        used += length > 0 ? (size_t)length : 0;
    }
    return iso_fault_set_code(fault, ISO_FAULT_SENSOR_MISSING, -ENODEV,
                              "%s: no device%s%s; OpenNI2 sees:%s", owner, wanted ? " " : "",
                              wanted ? wanted : "", n > 0 ? seen : " none");
}

int iso__openni2_find_device(const char *wanted, OniDeviceInfo *out, struct iso_fault *fault)
{
    OniDeviceInfo *devices = NULL;
    int n = 0;
    const OniStatus status = oniGetDeviceList(&devices, &n);
    if (status != ONI_STATUS_OK) {
        return iso__openni2_refuse(status, "devices cannot be listed", fault);
    }
    const OniDeviceInfo *found = choose(devices, n, wanted);
    if (found) {
        *out = *found;
    }
    const int error = found ? 0 : none_such(devices, n, wanted, fault);
    (void)oniReleaseDeviceList(devices);
    return error;
}

int iso__openni2_find_file(const char *path, OniDeviceInfo *out, struct iso_fault *fault)
{
    char full[PATH_MAX];
    const int error = iso_file_check(path, ISO_FILE_ANY_SIZE, fault);
    if (error && error != -ENOENT && error != -EACCES) {
        return error == -ENOMEM ? error : -EINVAL; /* not a regular file, or a wrong name */
    }
    if (!realpath(path, full)) {
        return iso_fault_set_code(fault,
                                  errno == EACCES ? ISO_FAULT_FILE_DENIED : ISO_FAULT_FILE_MISSING,
                                  errno == EACCES ? -EACCES : -ENODEV, "%s: %s: %m", owner, path);
    }
    if (strlen(full) >= sizeof out->uri) {
        return iso_fault_set(fault, -EINVAL, "%s: %s: name too long for OpenNI2", owner, path);
    }
    memset(out, 0, sizeof *out);
    (void)strcpy(out->uri, full);
    return 0;
}

/* ---- available devices ------------------------------------------------------ */

int iso__openni2_probe(iso_sensor_visitor *visit, void *context, struct iso_fault *fault)
{
    OniDeviceInfo *devices = NULL;
    int n = 0, error = iso__openni2_start_runtime(fault);
    if (error) {
        return error;
    }
    const OniStatus status = oniGetDeviceList(&devices, &n);
    if (status != ONI_STATUS_OK) {
        error = iso__openni2_refuse(status, "devices cannot be listed", fault);
    }
    for (int i = 0; !error && i < n; i++) {
        struct iso_sensor_device device = {.depth = true};
        (void)snprintf(device.id, sizeof device.id, "%s", devices[i].uri);
        (void)snprintf(device.label, sizeof device.label, "%.60s %.60s", devices[i].vendor,
                       devices[i].name);
        visit(&device, context);
    }
    if (devices) {
        (void)oniReleaseDeviceList(devices);
    }
    oniShutdown();
    return error;
}
