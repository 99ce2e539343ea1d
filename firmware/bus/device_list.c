#include "firmware/bus/device_list.h"

#include <errno.h>

#include "drivers/sensor/contract/sensor.h"
#include "firmware/contract/json_line.h"

struct listing {
    FILE *out;
    const char *sensor;
};

static void print_line(struct iso_json_line *line, FILE *out)
{
    if (iso_json_line_end(line) > 0) {
        fputs(line->text, out);
    }
}

static void print_device(const struct iso_sensor_device *device, void *context)
{
    const struct listing *listing = context;
    struct iso_json_line line;

    iso_json_line_begin(&line);
    iso_json_line_string(&line, "sensor", listing->sensor);
    iso_json_line_string(&line, "id", device->id);
    iso_json_line_string(&line, "label", device->label);
    if (device->depth) {
        iso_json_line_string(&line, "kind", "depth");
    }
    if (device->code != ISO_FAULT_NONE) {
        iso_json_line_string(&line, "code", iso_fault_code_name(device->code));
    }
    print_line(&line, listing->out);
}

static void print_fault(const char *sensor, const struct iso_fault *fault, FILE *out)
{
    struct iso_json_line line;

    iso_json_line_begin(&line);
    iso_json_line_string(&line, "sensor", sensor);
    iso_json_line_string(&line, "fault", fault->text);
    if (fault->code != ISO_FAULT_NONE) {
        iso_json_line_string(&line, "code", iso_fault_code_name(fault->code));
    }
    print_line(&line, out);
}

int iso_device_list_print(FILE *out, struct iso_fault *fault)
{
    const char *sensor;

    for (size_t i = 0; (sensor = iso_sensor_registered(i)); i++) {
        struct listing listing = {.out = out, .sensor = sensor};
        struct iso_fault why = {.text = ""};
        const int error = iso_sensor_probe(sensor, print_device, &listing, &why);
        if (error && error != -ENOSYS) {
            print_fault(sensor, &why, out);
        }
    }
    return fflush(out) || ferror(out) ? iso_fault_set(fault, -EIO, "cannot write the list: %m") : 0;
}
