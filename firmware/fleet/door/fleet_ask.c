/* What the door asks the hub. */
#include <errno.h>
#include <sodium.h>
#include <string.h>

#include "firmware/fleet/door/fleet_state.h"

static int finish(int error, struct iso_fault *fault)
{
    return error ? iso_fault_set(fault, error, "fleet: %s",
                                 error == -ENOMEM ? "out of memory" : strerror(-error))
                 : 0;
}

/* The health of the door: a JSON object for people. */
static size_t write_health(const struct iso_fleet *fleet, struct iso_json_line *line)
{
    const struct iso_fleet_host *host = &fleet->options.host;
    const struct iso__fleet_zone *zones[ISO_FLEET_ZONES_MAX];
    const size_t n = iso__fleet_zones(&fleet->record, zones);
    bool behind = false, whole = false;
    for (size_t i = 0; i < n; i++) {
        behind |= zones[i]->behind;
        whole |= zones[i]->wants_snapshot;
    }
    iso_json_line_begin(line);
    iso_json_line_integer(line, "people", (int64_t)(fleet->index.n - fleet->index.n_local));
    iso_json_line_integer(line, "local-people", (int64_t)fleet->index.n_local);
    iso_json_line_integer(line, "hub-behind", behind);
    iso_json_line_integer(line, "wants-snapshot", whole);
    iso_json_line_integer(line, "message-version", ISO_FLEET_VERSION);
    iso_json_line_string(line, "fault", fleet->fault.text);
    iso__fleet_write_update(fleet, line);
    if (host->health) {
        host->health(host->context, line);
    }
    const size_t length = iso_json_line_end(line);
    return length > 0 ? length - 1 : 0; /* without the newline */
}

/* Keeps a question until its answer comes, if need be in place of the oldest one. */
static void expect_answer(struct iso_fleet *fleet, const struct iso_fleet_question *question,
                          const struct iso_fleet_clocks *at)
{
    if (fleet->n_questions == ISO__FLEET_QUESTIONS) {
        memmove(fleet->questions, fleet->questions + 1,
                --fleet->n_questions * sizeof *fleet->questions);
    }
    struct iso__fleet_question *kept = &fleet->questions[fleet->n_questions++];
    *kept = (struct iso__fleet_question){.at = *at, .n = question->n};
    memcpy(kept->nonce, question->nonce, sizeof kept->nonce);
    for (size_t i = 0; i < question->n; i++) {
        kept->places[i] = question->places[i];
    }
}

int iso_fleet_question(struct iso_fleet *fleet, struct iso_fleet_bytes *out,
                       struct iso_fault *fault)
{
    const struct iso_fleet_host *host = &fleet->options.host;
    const struct iso__fleet_zone *zones[ISO_FLEET_ZONES_MAX];
    struct iso_json_line health;
    int error = iso__fleet_ready(fleet, fault);
    if (error) {
        return error;
    }
    const struct iso_fleet_clocks now = iso__fleet_now(fleet);
    struct iso_fleet_question question = {
        .door = fleet->record.member.door,
        .time_s = now.date_known ? now.date_s : 0,
        .algorithm = fleet->options.algorithm,
        .last_event = host->last_event(host->context),
        .n = iso__fleet_zones(&fleet->record, zones),
        .health = health.text,
        .health_length = write_health(fleet, &health),
    };
    for (size_t i = 0; i < question.n; i++) {
        question.places[i] = zones[i]->place;
    }
    randombytes_buf(question.nonce, sizeof question.nonce);
    struct iso_fleet_signer signer;
    struct iso_fleet_receiver receiver;
    host->keys(host->context, &signer, &receiver);
    error = iso_fleet_make_question(&question, &signer, out);
    sodium_memzero(&signer, sizeof signer);
    sodium_memzero(&receiver, sizeof receiver);
    if (!error) {
        expect_answer(fleet, &question, &now);
    }
    return finish(error, fault);
}

int iso__fleet_sign_fetch(struct iso_fleet *fleet, struct iso_fleet_fetch *fetch,
                          struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    const struct iso_fleet_host *host = &fleet->options.host;
    const struct iso_fleet_clocks now = iso__fleet_now(fleet);
    struct iso_fleet_signer signer;
    struct iso_fleet_receiver receiver;
    fetch->door = fleet->record.member.door;
    fetch->time_s = now.date_known ? now.date_s : 0;
    randombytes_buf(fetch->nonce, sizeof fetch->nonce);
    host->keys(host->context, &signer, &receiver);
    const int error = iso_fleet_make_fetch(fetch, &signer, out);
    sodium_memzero(&signer, sizeof signer);
    sodium_memzero(&receiver, sizeof receiver);
    return finish(error, fault);
}

int iso_fleet_fetch(struct iso_fleet *fleet, const struct iso_fleet_id *zone,
                    enum iso_fleet_wanted what, struct iso_fleet_bytes *out,
                    struct iso_fault *fault)
{
    const int error = iso__fleet_ready(fleet, fault);
    if (error) {
        return error;
    }
    const struct iso__fleet_zone *own = iso__fleet_zone_of(&fleet->record, zone);
    if (!own) {
        return iso_fault_set(fault, -ENXIO, "the zone is not one of this door");
    }
    struct iso_fleet_fetch fetch = {.zone = *zone, .after = own->place.sequence, .what = what};
    return iso__fleet_sign_fetch(fleet, &fetch, out, fault);
}
