/* Sets up the counter of the state directory as the configuration says. */
#include <errno.h>
#include <string.h>

#include "drivers/counter/tpm2_counter.h"
#include "firmware/daemon/components.h"

int iso_components_check_counter(const struct iso_config *config, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    uint32_t index = 0;
    if (config->seal.counter == ISO_COUNTER_NONE) {
        return 0;
    }
    if (!*config->seal.counter_tcti) {
        return iso_fault_set_code(fault, ISO_FAULT_CONFIG_WRONG, -EINVAL,
                                  "[seal] counter_tcti: is empty");
    }
    const int error = iso_tpm2_index_parse(config->seal.counter_index, &index, &why);
    return error ? iso_fault_set_code(fault, why.code, error, "[seal] counter_index: %s", why.text)
                 : 0;
}

int iso_components_open_counter(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_config_seal *seal = &components->config.seal;
    struct iso_counter device = {0};
    uint32_t index = 0;
    if (components->counter || seal->counter == ISO_COUNTER_NONE) {
        return 0;
    }
    int error = iso_tpm2_index_parse(seal->counter_index, &index, fault);
    if (!error) {
        error = iso_tpm2_counter_open(seal->counter_tcti, index, &device, fault);
    }
    if (error) {
        return error;
    }
    error = iso_state_counter_new(&device, &components->times, &components->counter);
    if (error) {
        iso_counter_close(&device);
        return iso_fault_set(fault, error, "the counter of the state: out of memory");
    }
    return 0;
}

/* Checks whether the increment that followed the anchor succeeded. */
static int check_increment(struct iso_state_counter *counter, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    int error = 0;
    return iso_state_counter_take_news(counter, &error, &why) && error
               ? iso_fault_set_code(fault, why.code, error, "%s", why.text)
               : 0;
}

int iso_components_begin_counter(struct iso_components *components, bool threaded,
                                 struct iso_fault *fault)
{
    struct iso_state_counter *counter = components->counter;
    if (!counter) {
        return 0;
    }
    int error = iso_state_counter_begin(counter, fault);
    if (!error) {
        error = iso_audit_renew_anchor(components->audit, fault);
    }
    if (!error) {
        error = check_increment(counter, fault);
    }
    if (!error && threaded) {
        error = iso_state_counter_start_thread(counter);
        if (error) {
            (void)iso_fault_set(fault, error, "the counter of the state: %s", strerror(-error));
        }
    }
    if (!error) {
        iso_components_forget_reset(&components->config);
    }
    return error;
}
