/* The metric of the site of the script. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/fake_service.h"
#include "tests/enroll/rigs/fake_status.h"

int fake_site_append(sd_bus_message *reply, const struct fake_script *script)
{
    const char *site = script->site ? script->site : ISO_CONTRACT_SITE_OFF;
    int r = sd_bus_message_append(reply, "{sv}", "site", "s", site);
    if (r < 0 || strcmp(site, ISO_CONTRACT_SITE_OFF) == 0) {
        return r;
    }
    return sd_bus_message_append(
        reply, "{sv}{sv}{sv}{sv}{sv}{sv}{sv}", "site-other-sensor", "u", script->site_other,
        "site-people", "u", script->site_people, "site-taught", "u", (uint32_t)1, "site-least", "u",
        (uint32_t)3, "site-offset", "d", 6.314, "site-expected", "d", 5.1, "site-growth", "d", 1.1);
}

static int append_estimate(sd_bus_message *reply)
{
    int r = sd_bus_message_append(reply, "{sv}{sv}{sv}", "estimate-people", "u", (uint32_t)4,
                                  "estimate-same", "t", (uint64_t)7, "estimate-others", "t",
                                  (uint64_t)90);
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}{sv}{sv}{sv}", "balanced-score", "d", 3.0,
                                  "balanced-fmr", "d", 0.0111, "balanced-fmr-low", "d", 0.0012,
                                  "balanced-fmr-high", "d", 0.0534);
    }
    return r < 0 ? r
                 : sd_bus_message_append(reply, "{sv}{sv}", "look-alike-score", "d", 2.0,
                                         "look-alikes", "u", (uint32_t)1);
}

static int answer(sd_bus_message *call,
                  int (*append)(sd_bus_message *reply, const struct fake_script *script),
                  const struct fake_script *script)
{
    sd_bus_message *reply = NULL;
    int r = sd_bus_message_new_method_return(call, &reply);
    if (r >= 0) {
        r = append(reply, script);
    }
    if (r >= 0) {
        r = sd_bus_send(NULL, reply, NULL);
    }
    sd_bus_message_unref(reply);
    return r;
}

static int append_site(sd_bus_message *reply, const struct fake_script *script)
{
    int r = sd_bus_message_open_container(reply, 'a', "{sv}");
    if (r >= 0) {
        r = fake_site_append(reply, script);
    }
    if (r >= 0 && script->site_estimated) {
        r = append_estimate(reply);
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

static int append_pairs(sd_bus_message *reply, const struct fake_script *script)
{
    return script->site_estimated
               ? sd_bus_message_append(reply, "a(ssd)", 1, "anna", "Bo Ek", 2.347)
               : sd_bus_message_append(reply, "a(ssd)", 0);
}

int fake_on_get_site(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    return fake_fails(service, call, error) ? -EIO : answer(call, append_site, service->script);
}

int fake_on_list_look_alikes(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    return fake_fails(service, call, error) ? -EIO : answer(call, append_pairs, service->script);
}

/* As many people as the script says: anna, and others. */
static int append_others(sd_bus_message *reply, const struct fake_script *script)
{
    int r = sd_bus_message_open_container(reply, 'a', "s");
    for (uint32_t i = 0; r >= 0 && i < script->site_other; i++) {
        char name[16] = "anna";
        if (i > 0) {
            (void)snprintf(name, sizeof name, "carl %u", (unsigned)i);
        }
        r = sd_bus_message_append_basic(reply, 's', name);
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

int fake_on_list_other(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    return fake_fails(service, call, error) ? -EIO : answer(call, append_others, service->script);
}

/* ResetSite and RollBackSite: the number of people stands for that of their templates. */
int fake_on_take_back(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    return fake_fails(service, call, error)
               ? -EIO
               : sd_bus_reply_method_return(call, "u", service->script->site_people);
}
