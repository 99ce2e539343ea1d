#include "tests/enroll/rigs/fake_status.h"

static int append_numbers(sd_bus_message *reply, const struct fake_script *script)
{
    uint32_t templates = 0;

    for (size_t i = 0; i < script->n_people; i++) {
        templates += script->people[i].templates;
    }
    static unsigned asked; /* how often, if frames come */
    asked += script->frames_come;
    int r = sd_bus_message_append(reply, "{sv}", "uptime-ms", "x", (int64_t)7530000 + 1000 * asked);
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "distance-mm", "d", 612.4);
    }
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "fit-coverage", "d", 0.934);
    }
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "people", "u", (uint32_t)script->n_people);
    }
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "templates", "u", templates + 3);
    }
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "templates-usable", "u", templates);
    }
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "threshold", "d", 1.25);
    }
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "frames", "t", ((uint64_t)1 << 40) + 30 * asked);
    }
    if (r >= 0 && script->key_place) {
        r = sd_bus_message_append(reply, "{sv}", "key-place", "s", script->key_place);
    }
    return r < 0 ? r
                 : sd_bus_message_append(reply, "{sv}", "log-sequence", "t",
                                         (uint64_t)script->n_records);
}

int fake_status_append(sd_bus_message *reply, const struct fake_script *script)
{
    const struct {
        const char *key, *value, *otherwise;
    } texts[] = {
        {"version", script->version, ISOTHERM_VERSION},
        {"model", script->model, "00c0ffee"},
        {"sensor-state", script->sensor_state, "started"},
        {"sensor-devices", script->sensor_devices, ""},
        {"sensor-devices-code", script->sensor_devices_code, ""},
        {"sensor-fault", script->sensor_fault, ""},
        {"sensor-fault-code", script->sensor_fault_code, ""},
        {"sensor-health", script->sensor_health, ""},
        {"sensor-health-code", script->sensor_health_code, ""},
        {"sensor-calibration", script->sensor_calibration, ""},
        {"sensor-calibration-code", script->sensor_calibration_code, ""},
        {"door", script->door, "gpiod"},
        {"door-state", script->door_state, "locked"},
        {"door-lines", script->door_lines, ""},
        {"door-fault", script->door_fault, ""},
        {"door-fault-code", script->door_fault_code, ""},
        {"counter-fault", script->counter_fault, ""},
        {"counter-fault-code", script->counter_fault_code, ""},
        {"panel-fault", script->panel_fault, ""},
        {"panel-fault-code", script->panel_fault_code, ""},
        {"stale-fault", script->stale_fault, ""},
        {"stale-fault-code", script->stale_fault_code, ""},
        {"storage-fault", script->storage_fault, ""},
        {"storage-fault-code", script->storage_fault_code, ""},
        {"clock-fault", script->clock_fault, ""},
        {"clock-fault-code", script->clock_fault_code, ""},
    };
    int r = sd_bus_message_open_container(reply, 'a', "{sv}");
    for (size_t i = 0; r >= 0 && i < sizeof texts / sizeof *texts; i++) {
        r = sd_bus_message_append(reply, "{sv}", texts[i].key, "s",
                                  texts[i].value ? texts[i].value : texts[i].otherwise);
    }
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "door-realtime", "b", (int)!script->door_ordinary);
    }
    if (r >= 0) {
        r = fake_site_append(reply, script);
    }
    if (r >= 0) {
        r = append_numbers(reply, script);
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}
