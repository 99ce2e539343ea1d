/* The table of the back ends, made from the list in back_ends.def. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "drivers/sensor/contract/sensor.h"

#define BACK_END(ops) extern const struct iso_sensor_ops ops;
#include "drivers/sensor/back_ends.def"
#undef BACK_END

static const struct iso_sensor_ops *const back_ends[] = {
#define BACK_END(ops) &(ops),
#include "drivers/sensor/back_ends.def"
#undef BACK_END
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

const struct iso_option_spec *iso_sensor_options(const char *name)
{
    const struct iso_sensor_ops *ops = find(name);
    return ops ? ops->options : NULL;
}

static int unknown_back_end(const char *name, struct iso_fault *fault)
{
    char known[128] = "";
    size_t used = 0;
    for (size_t i = 0; i < BACK_ENDS && used < sizeof known; i++) {
        const int length = snprintf(known + used, sizeof known - used, " %s", back_ends[i]->name);
        used += length > 0 ? (size_t)length : 0;
    }
    return iso_fault_set_code(fault, ISO_FAULT_DRIVER_UNKNOWN, -ENOENT,
                              "no sensor '%s'; there are:%s", name, known);
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
    return ops ? iso_sensor_check_ops(ops, options, n_options, fault)
               : unknown_back_end(name, fault);
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
        return iso_fault_set(fault, -ENOSYS, "sensor %s: cannot list its devices", name);
    }
    return ops->probe(visit, context, fault);
}
