/* The methods about the metric of the site. They tell what the people have taught it, the error
 * rates that are estimated from their templates, and who looks alike; and they take back what the
 * metric has learned. */
#include <stdio.h>

#include "firmware/appliance/administration.h"
#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"

static const char *const levels[ISO_SITE_LEVELS] = {
    ISO_CONTRACT_LEVEL_CONVENIENT, ISO_CONTRACT_LEVEL_BALANCED, ISO_CONTRACT_LEVEL_STRICT};

/* ---- what the people have taught ---- */

static const char *site_word(const struct iso_site_state *state)
{
    if (!state->adapts) {
        return ISO_CONTRACT_SITE_OFF;
    }
    return state->adapted ? ISO_CONTRACT_SITE_ADAPTED : ISO_CONTRACT_SITE_PROVISIONAL;
}

int iso__bus_append_site(sd_bus_message *reply, const struct iso_bus *bus)
{
    const struct iso_site_state state = iso_gallery_site(bus->borrowed->gallery);
    const struct iso_site_summary *summary = &state.summary;
    int r = sd_bus_message_append(reply, "{sv}", "site", "s", site_word(&state));
    if (r < 0 || !state.adapts) {
        return r;
    }
    const size_t excluded = iso_gallery_site_excluded(bus->borrowed->gallery);
    const size_t other = iso_gallery_site_other(bus->borrowed->gallery);
    r = sd_bus_message_append(reply, "{sv}{sv}{sv}{sv}{sv}", "site-excluded", "u",
                              (uint32_t)excluded, "site-other-sensor", "u", (uint32_t)other,
                              "site-people", "u", (uint32_t)summary->people, "site-taught", "u",
                              (uint32_t)summary->taught, "site-least", "u",
                              (uint32_t)ISO_SITE_PEOPLE_MIN);
    return r < 0 ? r
                 : sd_bus_message_append(reply, "{sv}{sv}{sv}", "site-offset", "d", summary->offset,
                                         "site-expected", "d", summary->expected, "site-growth",
                                         "d", summary->growth);
}

/* ---- error rates ---- */

static int append_number(sd_bus_message *reply, const char *level, const char *key, double value)
{
    char name[64];
    (void)snprintf(name, sizeof name, "%s-%s", level, key);
    return sd_bus_message_append(reply, "{sv}", name, "d", value);
}

/* Appends a rate of a level with its interval, if there was a comparison. */
static int append_rate(sd_bus_message *reply, const char *level, const char *key,
                       const struct iso_people_rate *rate, struct iso_interval interval)
{
    char low[32], high[32];
    if (rate->trials == 0) {
        return 0;
    }
    (void)snprintf(low, sizeof low, "%s-low", key);
    (void)snprintf(high, sizeof high, "%s-high", key);
    int r = append_number(reply, level, key, iso_people_rate_value(rate));
    if (r >= 0) {
        r = append_number(reply, level, low, interval.low);
    }
    return r < 0 ? r : append_number(reply, level, high, interval.high);
}

static int append_levels(sd_bus_message *reply, const struct iso_site_estimate *estimate)
{
    int r = 0;
    for (int l = 0; r >= 0 && l < ISO_SITE_LEVELS; l++) {
        const struct iso_people_rate *same = &estimate->level[l].same;
        const struct iso_people_rate *others = &estimate->level[l].others;
        r = append_number(reply, levels[l], "score", estimate->level[l].score);
        if (r >= 0) {
            r = append_rate(reply, levels[l], "fmr", others, iso_people_rate_pair_interval(others));
        }
        if (r >= 0) {
            r = append_rate(reply, levels[l], "fnmr", same, iso_people_rate_interval(same));
        }
    }
    return r;
}

/* The score at which two people look alike: one below the score that a face needs now. */
static double alike_from(const struct iso_bus *bus)
{
    size_t n = 0;
    const bool provisional = iso_site_is_provisional(iso_gallery_site(bus->borrowed->gallery));
    (void)iso_gallery_people(bus->borrowed->gallery, &n);
    return iso_config_threshold_among(bus->borrowed->config, n, provisional) - 1.0;
}

static uint32_t count_alike(const struct iso_site_estimate *estimate, double from)
{
    uint32_t n = 0;
    while ((int)n < estimate->n_pairs && estimate->pair[n].score >= from) {
        n++;
    }
    return n;
}

static int append_estimate(sd_bus_message *reply, const struct iso_bus *bus,
                           const struct iso_site_estimate *estimate)
{
    const double from = alike_from(bus);
    int r = sd_bus_message_append(
        reply, "{sv}{sv}{sv}{sv}", "estimate-people", "u", (uint32_t)estimate->people,
        "estimate-repeated", "u", (uint32_t)estimate->repeated, "estimate-same", "t",
        (uint64_t)estimate->level[0].same.trials, "estimate-others", "t",
        (uint64_t)estimate->level[0].others.trials / 2); /* counted for both people */
    if (r >= 0) {
        r = append_levels(reply, estimate);
    }
    return r < 0 ? r
                 : sd_bus_message_append(reply, "{sv}{sv}", "look-alike-score", "d", from,
                                         "look-alikes", "u", count_alike(estimate, from));
}

static int append_all(sd_bus_message *reply, const struct iso_bus *bus)
{
    struct iso_site_estimate estimate;
    int r = sd_bus_message_open_container(reply, 'a', "{sv}");
    if (r >= 0) {
        r = iso__bus_append_site(reply, bus);
    }
    if (r >= 0 && iso_gallery_site_estimate(bus->borrowed->gallery, &estimate)) {
        r = append_estimate(reply, bus, &estimate);
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

int iso__bus_get_site(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    sd_bus_message *reply = NULL;
    const int r = sd_bus_message_new_method_return(call, &reply);
    (void)out;
    return iso__bus_send_reply(reply, r < 0 ? r : append_all(reply, bus));
}

/* ---- people who look alike ---- */

static int append_pairs(sd_bus_message *reply, const struct iso_bus *bus)
{
    const struct iso_gallery *gallery = bus->borrowed->gallery;
    struct iso_site_estimate estimate = {.n_pairs = 0};
    const bool known = iso_gallery_site_estimate(bus->borrowed->gallery, &estimate);
    const uint32_t n = known ? count_alike(&estimate, alike_from(bus)) : 0;
    int r = sd_bus_message_open_container(reply, 'a', "(ssd)");
    for (uint32_t i = 0; r >= 0 && i < n; i++) {
        const struct iso_person *person = iso_gallery_find_id(gallery, estimate.pair[i].person);
        const struct iso_person *other = iso_gallery_find_id(gallery, estimate.pair[i].other);
        if (person && other) {
            r = sd_bus_message_append(reply, "(ssd)", person->name, other->name,
                                      estimate.pair[i].score);
        }
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

int iso__bus_list_look_alikes(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return iso__bus_reply_list(call, context, append_pairs, out);
}

/* ---- people of another sensor ---- */

static int append_others(sd_bus_message *reply, const struct iso_bus *bus)
{
    const struct iso_gallery *gallery = bus->borrowed->gallery;
    size_t n = 0;
    const struct iso_person *people = iso_gallery_people(gallery, &n);
    int r = sd_bus_message_open_container(reply, 'a', "s");
    for (size_t i = 0; r >= 0 && i < n; i++) {
        if (iso_gallery_is_other(gallery, people[i].id)) {
            r = sd_bus_message_append_basic(reply, 's', people[i].name);
        }
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

int iso__bus_list_other(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return iso__bus_reply_list(call, context, append_others, out);
}

/* ---- taking it back ---- */

typedef int (*take_back_fn)(struct iso_appliance *appliance, const char *who, size_t *n,
                            struct iso_fault *fault);

static int take_back(sd_bus_message *call, const struct iso_bus *bus, take_back_fn act,
                     sd_bus_error *out)
{
    struct iso_fault fault = {.text = ""};
    char who[64];
    size_t n = 0;
    iso__bus_describe_caller(call, who, sizeof who);
    const int r = act(bus->appliance, who, &n, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault)
                 : sd_bus_reply_method_return(call, "u", (uint32_t)n);
}

int iso__bus_reset_site(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return take_back(call, context, iso_appliance_reset_site, out);
}

int iso__bus_roll_back_site(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return take_back(call, context, iso_appliance_roll_back_site, out);
}
