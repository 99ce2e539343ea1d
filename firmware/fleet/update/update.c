#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "firmware/fleet/update/update_inner.h"

enum {
    LOOK_AGAIN_S = 60, /* RAUC was busy or did not answer */
    SPREAD_MOST_S = 4 * 3600,
    HOLDS_S = 15 * 60,   /* doors ask each minute */
    ANSWERS_WITHOUT = 2, /* the order holds so long; one of them may have lost it */
    TEXT_SIZE = 4096,
    EXIT_NO_IMAGE = 3, /* isotherm(1): not found */
};

#define TIMER_ACCURACY_US 100000

#define PART    "hub/bundle.part"
#define BUNDLE  "hub/bundle.raucb"
#define RESTART "hub/restart"
#define RECORD  "update.record"

void link_update_note(const struct link_update *u, const char *line)
{
    if (u->setup.note) {
        u->setup.note(u->setup.note_context, line);
    }
}

uint64_t link_update_now_us(const struct link_update *u)
{
    uint64_t now = 0;

    (void)sd_event_now(u->setup.event, CLOCK_BOOTTIME, &now);
    return now;
}

void link_update_in(struct link_update *u, uint64_t delay_us)
{
    (void)sd_event_source_set_time(u->timer, link_update_now_us(u) + delay_us);
    (void)sd_event_source_set_enabled(u->timer, SD_EVENT_ONESHOT);
}

/* ---- what is told and stored ---- */

/* A version that another way has brought is being checked. A door that was told nothing and says
 * that it runs a version is healthy for the hub, so it says that the version is installed. */
static bool is_foreign_trial(const struct link_update *u)
{
    return u->record.state == ISO_FLEET_UPDATE_IDLE && link_update_is_on_trial(u);
}

static enum iso_fleet_update_state told_state(const struct link_update *u)
{
    return u->step == LINK_UPDATE_OFF ? ISO_FLEET_UPDATE_NONE
           : is_foreign_trial(u)      ? ISO_FLEET_UPDATE_INSTALLED
                                      : u->record.state;
}

void link_update_tell(struct link_update *u)
{
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_update_report *report = &u->report;

    *report = (struct iso_fleet_update_report){.is_known = true, .state = told_state(u)};
    if (!is_foreign_trial(u) || strcmp(u->slots.version, u->record.version) == 0) {
        report->rollout = u->record.rollout;
    }
    memcpy(report->version, u->slots.version, sizeof report->version);
    memcpy(report->board, u->slots.board, sizeof report->board);
    memcpy(report->fault, u->record.fault, sizeof report->fault);
    /* A daemon that does not answer is told again with the next answer of the hub; until then the
     * machine does not restart. */
    if (u->setup.daemon.update(u->setup.daemon.context, report, &u->busy, &fault) < 0) {
        u->busy = true;
    }
}

void link_update_set(struct link_update *u, enum iso_fleet_update_state state, const char *text)
{
    struct iso_fault fault = {.text = ""};

    u->record.state = state;
    iso_fleet_update_fault_copy(u->record.fault, text);
    if (link_update_record_write(u->record_file, &u->record, &fault) < 0) {
        link_update_note(u, fault.text);
    }
    link_update_tell(u);
}

void link_update_fail(struct link_update *u, const char *fault)
{
    link_update_fetch_end(u);
    (void)unlink(u->file);
    u->step = LINK_UPDATE_IDLE;
    link_update_set(u, ISO_FLEET_UPDATE_FAILED, fault);
    link_update_note(u, u->record.fault);
}

void link_update_cancel(struct link_update *u, bool keeps_file)
{
    link_update_fetch_end(u);
    u->step = LINK_UPDATE_IDLE;
    if (keeps_file) {
        link_update_in(u, LINK_UPDATE_KEEPS_S * LINK_UPDATE_S_US);
    } else {
        (void)unlink(u->file);
    }
    link_update_set(u, ISO_FLEET_UPDATE_IDLE, "");
}

/* ---- the slots ---- */

static int on_look(sd_event_source *source, int fd, uint32_t events, void *context)
{
    struct link_update *u = context;
    char text[TEXT_SIZE];
    const int exit = link_update_ended(u, text, sizeof text);

    (void)source, (void)fd, (void)events;
    if (exit == EXIT_NO_IMAGE) {
        u->step = LINK_UPDATE_OFF;
        link_update_tell(u);
    } else if (exit == 0 && link_update_slots_read(text, &u->slots) == 0) {
        link_update_settle(u);
    } else {
        link_update_in(u, LOOK_AGAIN_S * LINK_UPDATE_S_US);
    }
    return 0;
}

static void look(struct link_update *u)
{
    const int r = link_update_run(u, on_look);

    if (r == -ENOENT || r == -EACCES) { /* without the program there is no image */
        u->step = LINK_UPDATE_OFF;
        link_update_tell(u);
    } else if (r < 0) {
        link_update_in(u, LOOK_AGAIN_S * LINK_UPDATE_S_US);
    }
}

static int on_time(sd_event_source *source, uint64_t at_us, void *context)
{
    struct link_update *u = context;

    (void)source, (void)at_us;
    switch (u->step) {
    case LINK_UPDATE_LOOK:
        look(u);
        break;
    case LINK_UPDATE_WAIT:
        link_update_fetch_begin(u);
        break;
    case LINK_UPDATE_FETCH:
        link_update_fetch_next(u);
        break;
    case LINK_UPDATE_CHECK:
        link_update_check_next(u);
        break;
    case LINK_UPDATE_INSTALL:
        link_update_install(u);
        break;
    case LINK_UPDATE_INSTALLED:
        link_update_wait(u);
        break;
    case LINK_UPDATE_IDLE:
        (void)unlink(u->file); /* the order has not come again */
        break;
    case LINK_UPDATE_OFF:
        break;
    }
    return 0;
}

/* ---- the hub ---- */

uint64_t link_update_turn_us(const struct link_update *u)
{
    const uint64_t spread_s = u->order.spread_s < SPREAD_MOST_S ? u->order.spread_s : SPREAD_MOST_S;
    uint64_t random;

    randombytes_buf(&random, sizeof random);
    return random % (spread_s * LINK_UPDATE_S_US + 1);
}

static void begin(struct link_update *u)
{
    const bool is_same_file = memcmp(u->record.sha256, u->order.sha256, sizeof u->record.sha256) ==
                              0;

    link_update_fetch_end(u);
    if (!is_same_file) {
        (void)unlink(u->file);
    }
    const bool is_same = iso_fleet_id_is_same(&u->record.rollout, &u->order.rollout);
    struct link_update_record record = {.rollout = u->order.rollout};
    if (is_same) {
        memcpy(record.tries, u->record.tries, sizeof record.tries);
    }
    u->record = record;
    memcpy(u->record.version, u->order.version, sizeof u->record.version);
    memcpy(u->record.former, u->slots.version, sizeof u->record.former);
    memcpy(u->record.sha256, u->order.sha256, sizeof u->record.sha256);
    u->step = LINK_UPDATE_WAIT;
    link_update_set(u, ISO_FLEET_UPDATE_FETCHING, "");
    link_update_in(u, link_update_turn_us(u));
}

static bool is_fetched(const struct link_update *u)
{
    return u->step == LINK_UPDATE_WAIT || u->step == LINK_UPDATE_FETCH ||
           u->step == LINK_UPDATE_CHECK;
}

/* The order holds no more: nothing restarts for it. */
static void let_go(struct link_update *u)
{
    u->holds = false;
    if (is_fetched(u)) {
        link_update_cancel(u, false);
    }
}

/* Whether the door has done with this rollout. */
static bool is_over(const struct link_update *u, const struct iso_fleet_update *order)
{
    return strcmp(order->version, u->slots.version) == 0 ||
           (iso_fleet_id_is_same(&order->rollout, &u->record.rollout) &&
            (u->record.state == ISO_FLEET_UPDATE_FAILED ||
             u->record.state == ISO_FLEET_UPDATE_WENT_BACK));
}

void link_update_ordered(struct link_update *u, const struct iso_fleet_update *order)
{
    const bool is_same = iso_fleet_id_is_same(&order->rollout, &u->record.rollout);

    u->without = 0;
    /* The image refuses every update while the running version is on trial. */
    if (u->step == LINK_UPDATE_OFF || u->step == LINK_UPDATE_LOOK || link_update_is_on_trial(u)) {
        return; /* the order comes again */
    }
    if (is_over(u, order)) {
        if (!is_same) {
            let_go(u); /* the hub wants the running version, and not the one that waits */
        }
        return;
    }
    u->holds = is_same || u->step != LINK_UPDATE_INSTALL;
    u->holds_until_us = link_update_now_us(u) + HOLDS_S * LINK_UPDATE_S_US;
    if ((is_same && u->step != LINK_UPDATE_IDLE) || u->step == LINK_UPDATE_INSTALL) {
        return;
    }
    u->order = *order;
    begin(u);
}

void link_update_answered(struct link_update *u)
{
    /* The order of this answer comes behind it. */
    const bool is_gone = u->without++ >= ANSWERS_WITHOUT;

    if (is_gone && u->step == LINK_UPDATE_IDLE) {
        (void)unlink(u->file); /* of an order that was taken back while the link did not run */
    }
    if (is_gone) {
        let_go(u);
    }
    if (u->step != LINK_UPDATE_LOOK) {
        link_update_tell(u); /* the daemon may have been started again */
    }
}

const struct iso_fleet_update_report *link_update_report(const struct link_update *u)
{
    return &u->report;
}

static bool join(char out[PATH_MAX], const char *folder, const char *name)
{
    return snprintf(out, PATH_MAX, "%s/%s", folder, name) < PATH_MAX;
}

void link_update_forget(const char *folder, const char *updates)
{
    const char *const names[][2] = {
        {updates, PART}, {updates, BUNDLE}, {updates, RESTART}, {folder, RECORD}};
    char path[PATH_MAX];

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (join(path, names[i][0], names[i][1])) {
            (void)unlink(path);
        }
    }
}

/* ---- begin and end ---- */

static char *copy(const char *text)
{
    return text ? strdup(text) : NULL;
}

static int copy_setup(struct link_update *u, const struct link_update_setup *setup)
{
    u->setup = *setup;
    u->setup.hub_url = copy(setup->hub_url);
    u->setup.ca_file = copy(setup->ca_file);
    u->setup.folder = copy(setup->folder);
    u->setup.program = copy(setup->program);
    u->setup.event = sd_event_ref(setup->event);
    u->setup.updates = NULL; /* the names below have it */
    if (!u->setup.hub_url || !u->setup.folder || !u->setup.program ||
        !u->setup.ca_file != !setup->ca_file) {
        return -ENOMEM;
    }
    const bool fits = join(u->file, setup->updates, PART) &&
                      join(u->bundle, setup->updates, BUNDLE) &&
                      join(u->restart_file, setup->updates, RESTART) &&
                      join(u->taken_file, setup->updates, "hub.raucb") &&
                      join(u->result_file, setup->updates, "result-hub.json") &&
                      join(u->record_file, setup->folder, RECORD);
    return fits ? 0 : -ENAMETOOLONG;
}

int link_update_new(const struct link_update_setup *setup, struct link_update **out,
                    struct iso_fault *fault)
{
    struct link_update *u = calloc(1, sizeof *u);

    if (!u) {
        return iso_fault_set(fault, -ENOMEM, "updates: out of memory");
    }
    u->fd = -1;
    u->child = (struct link_update_child){.pid_fd = -1, .out_fd = -1};
    int r = copy_setup(u, setup);
    r = r < 0 ? r
              : sd_event_add_time_relative(u->setup.event, &u->timer, CLOCK_BOOTTIME, 0,
                                           TIMER_ACCURACY_US, on_time, u);
    if (r < 0) {
        link_update_free(u);
        return iso_fault_set(fault, r, "updates: %s", strerror(-r));
    }
    link_update_record_read(u->record_file, &u->record);
    *out = u;
    return 0;
}

void link_update_free(struct link_update *u)
{
    if (!u) {
        return;
    }
    link_update_fetch_end(u);
    link_update_child_free(&u->child);
    sd_event_source_disable_unref(u->timer);
    sd_event_unref(u->setup.event);
    free((char *)(uintptr_t)u->setup.hub_url);
    free((char *)(uintptr_t)u->setup.ca_file);
    free((char *)(uintptr_t)u->setup.folder);
    free((char *)(uintptr_t)u->setup.program);
    free(u);
}
