/* The table of the back ends. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "drivers/sensor/contract/sensor.h"
#ifdef ISOTHERM_LIBCAMERA
#include "drivers/sensor/libcamera/sensor_libcamera_stereo.h"
#endif
#ifdef ISOTHERM_OPENNI2
#include "drivers/sensor/openni2/sensor_openni2.h"
#endif
#include "drivers/sensor/replay/sensor_replay.h"
#ifdef ISOTHERM_V4L2
#include "drivers/sensor/v4l2/sensor_v4l2.h"
#include "drivers/sensor/v4l2/sensor_v4l2_stereo.h"
#endif

static const struct iso_sensor_ops *const back_ends[] = {
    &iso_sensor_replay_ops,
#ifdef ISOTHERM_V4L2
    &iso_sensor_v4l2_ops,
#ifdef ISOTHERM_STEREO
    &iso_sensor_v4l2_stereo_ops,
#endif
#ifdef ISOTHERM_LIBCAMERA
    &iso_sensor_libcamera_stereo_ops,
#endif
#endif
#ifdef ISOTHERM_OPENNI2
    &iso_sensor_openni2_ops,
#endif
};

enum { BACK_ENDS = sizeof back_ends / sizeof back_ends[0] };

const char *iso_sensor_registered(size_t i)
{
    return i < BACK_ENDS ? back_ends[i]->name : NULL;
}

static const struct iso_sensor_ops *find(const char *name)
{
    for (size_t i = 0; i < BACK_ENDS; i++) {
        if (strcmp(back_ends[i]->name, name) == 0) {
            return back_ends[i];
        }
    }
    return NULL;
}

static int unknown_back_end(const char *name, struct iso_fault *fault)
{
    char known[128] = "";
    size_t used = 0;
    for (size_t i = 0; i < BACK_ENDS && used < sizeof known; i++) {
        int length = snprintf(known + used, sizeof known - used, " %s", back_ends[i]->name);
        used += length > 0 ? (size_t)length : 0;
    }
    return iso_fault_set(fault, -ENOENT, "no sensor '%s'; there are:%s", name, known);
}

int iso_sensor_load(const char *name, struct iso_fault *fault)
{
    const struct iso_sensor_ops *ops = find(name);
    if (!ops) {
        return unknown_back_end(name, fault);
    }
    return ops->load ? ops->load(fault) : 0;
}

int iso_sensor_check(const char *name, const struct iso_option *options, size_t n_options,
                     struct iso_fault *fault)
{
    const struct iso_sensor_ops *ops = find(name);
    return ops ? ops->check(options, n_options, fault) : unknown_back_end(name, fault);
}

int iso_sensor_open(const char *name, const struct iso_option *options, size_t n_options,
                    const struct iso_clock *clock, struct iso_sensor **out, struct iso_fault *fault)
{
    const struct iso_sensor_ops *ops = find(name);
    return ops ? iso_sensor_open_ops(ops, options, n_options, clock, out, fault)
               : unknown_back_end(name, fault);
}

bool iso_sensor_probes_at_once(const char *name)
{
    const struct iso_sensor_ops *ops = find(name);
    return ops && ops->probe && ops->probes_at_once;
}

int iso_sensor_probe(const char *name, iso_sensor_visitor *visit, void *context,
                     struct iso_fault *fault)
{
    const struct iso_sensor_ops *ops = find(name);
    if (!ops) {
        return unknown_back_end(name, fault);
    }
    if (!ops->probe) {
        return iso_fault_set(fault, -ENOSYS, "sensor %s: cannot tell what there is", name);
    }
    return ops->probe(visit, context, fault);
}
