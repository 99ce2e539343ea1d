/* Whether grants have enough time: the sensor's rate and the working time against stale_ms. */
#include "firmware/appliance/appliance_calls.h"

/* Compares the needed time with stale_ms. Warns once, until the sensor is opened again. */
static void judge(struct iso_appliance *appliance)
{
    struct iso_fault fault = {.text = ""};
    if (iso_stale_budget_is_tight(&appliance->stale.budget, &fault) && !appliance->stale.told) {
        iso__appliance_warn(appliance, &fault);
        appliance->stale.told = true;
    }
    appliance->stale.fault = fault;
}

void iso__appliance_stale_sensor(struct iso_appliance *appliance)
{
    const struct iso_config *config = appliance->borrowed.config;
    struct iso_stale_budget *budget = &appliance->stale.budget;
    struct iso_sensor_description description;
    const int error = iso_sensor_describe(appliance->sensor.supervisor.sensor, &description);
    budget->stale_ns = config->sensor.stale_ms * ISO_NS_PER_MS;
    budget->agree = config->decision.agree;
    budget->rate_hz = error ? 0 : description.rate_hz;
    appliance->stale.told = false;
    judge(appliance);
}

void iso__appliance_stale_agree(struct iso_appliance *appliance)
{
    appliance->stale.budget.agree = appliance->borrowed.config->decision.agree;
    judge(appliance);
}

void iso__appliance_stale_frame(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const int64_t took_ns = iso_times_now_ns(&appliance->borrowed.times) - frame->t_ns;
    iso_stale_budget_measure(&appliance->stale.budget, took_ns);
    judge(appliance);
}
