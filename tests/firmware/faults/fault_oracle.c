#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/faults/fault_world.h"
#include "tests/support/disk/broken_disk.h"

const char *const actor_names[ACTORS] = {[ANNA] = "anna", [BOB] = "bob", [CARL] = "carl"};

struct world_counts total;

bool world_is_faulty(const struct world *w, enum sim_fault fault)
{
    return fault_plan_at(&w->plan, w->step, fault) != NULL;
}

void world_broken(const struct world *w, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, " (seed %d, step %d)\n", (int)w->plan.seed, w->step);
    for (int i = 0; i < w->plan.n_events; i++) {
        const struct sim_fault_event *event = &w->plan.events[i];
        if (event->first <= w->step && w->step <= event->last) {
            fprintf(stderr, "  while %s since step %d\n", sim_fault_name(event->fault),
                    event->first);
        }
    }
    fail();
    abort();
}

void oracle_see(struct world *w, int64_t t_ns, enum actor actor, bool echo)
{
    const struct puppet_sensor *sensor = &w->rig->sensor;
    const uint64_t number = sensor->forgotten + (uint64_t)sensor->n_frames - 1;
    struct oracle *o = &w->oracle;
    if (o->n_seen == SEEN_MAX) {
        o->n_seen = SEEN_MAX / 2;
        memmove(o->seen, o->seen + SEEN_MAX / 2, SEEN_MAX / 2 * sizeof *o->seen);
    }
    o->seen[o->n_seen++] = (struct sight){t_ns, number, actor, echo};
}

static bool may_enter(const struct world *w, enum actor actor)
{
    const int64_t wall_s = w->rig->wall_ns / ISO_NS_PER_S;
    const int64_t bob_from_s = INT64_C(1795250000) - 86400, bob_until_s = 1795250000 + 86400;
    return actor == ANNA || (actor == CARL && w->oracle.carl_is_enrolled) ||
           (actor == BOB && wall_s >= bob_from_s && wall_s <= bob_until_s);
}

/* Counts the successive frames of this actor that end with o->seen[last]. A frame that repeats the
 * previous one does not count. Another actor or a gap ends the count. The result is 0 if seen[last]
 * is too old. */
static int frames_until(const struct world *w, enum actor actor, int last)
{
    const struct oracle *o = &w->oracle;
    const int64_t gap_ns = w->rig->config.decision.gap_ms * ISO_NS_PER_MS;
    const int64_t stale_ns = (w->rig->config.sensor.stale_ms + FRAME_MS) * ISO_NS_PER_MS;
    int64_t t_ns = w->rig->now_ns;
    int n = 0;
    for (int i = last; i >= 0; i--) {
        const int64_t reach_ns = i == last ? stale_ns : gap_ns;
        if (o->seen[i].actor != actor || t_ns - o->seen[i].t_ns > reach_ns) {
            break;
        }
        t_ns = o->seen[i].t_ns;
        n += !o->seen[i].echo;
    }
    return n;
}

uint64_t oracle_fetched(const struct world *w)
{
    return w->rig->sensor.forgotten + (uint64_t)w->rig->sensor.next;
}

/* Returns the highest count of frames_until() over the frames that the appliance has fetched since
 * the last observation. There are several of them if frames were late. */
static int frames_of(const struct world *w, enum actor actor)
{
    const struct oracle *o = &w->oracle;
    int most = 0;
    for (int last = o->n_seen - 1; last >= 0 && o->seen[last].number >= o->fetched; last--) {
        const int n = o->seen[last].number < oracle_fetched(w) ? frames_until(w, actor, last) : 0;
        most = n > most ? n : most;
    }
    return most;
}

/* Whether a lockdown or a lock-out certainly keeps the door shut. The last 200 ms of a lock-out do
 * not count. */
static bool is_shut(const struct world *w)
{
    return w->oracle.lockdown || w->rig->now_ns + 200 * ISO_NS_PER_MS < w->oracle.locked_until_ns;
}

static void judge_admission(struct world *w, const char *name)
{
    enum actor actor = ANNA;
    while (actor < STRANGER && strncmp(name, actor_names[actor], strlen(actor_names[actor])) != 0) {
        actor++;
    }
    if (actor == STRANGER || !may_enter(w, actor)) {
        world_broken(w, "let in a person who may not enter: %s", name);
    }
    if (frames_of(w, actor) < w->rig->config.decision.agree) {
        world_broken(w, "let in %s after %d frames", actor_names[actor], frames_of(w, actor));
    }
    if (w->oracle.claimed || is_shut(w)) {
        world_broken(w, "let in %s while nobody may enter", actor_names[actor]);
    }
    if (broken_disk.error) {
        world_broken(w, "let in %s without a record", actor_names[actor]);
    }
    w->oracle.allowed_ns = w->rig->now_ns;
    w->oracle.failures = 0;
    total.allowed++;
}

static void note_failure(struct world *w, bool attack)
{
    const struct iso_config_lockout *config = &w->rig->config.lockout;
    struct oracle *o = &w->oracle;
    const int64_t now_ns = w->rig->now_ns;
    if (now_ns < o->locked_until_ns) {
        return;
    }
    if (o->failed_ns && now_ns - o->failed_ns >= config->forget_ms * ISO_NS_PER_MS) {
        o->failures = o->attacks = o->locks = 0;
    }
    o->failed_ns = now_ns;
    o->attacks += attack;
    o->failures += !attack;
    if (o->failures >= config->failures || o->attacks >= config->attacks) {
        const int64_t length_ms = (int64_t)config->first_ms << (o->locks < 8 ? o->locks : 8);
        const int64_t most_ms = config->longest_ms;
        o->locked_until_ns = now_ns + (length_ms < most_ms ? length_ms : most_ms) * ISO_NS_PER_MS;
        o->failed_ns = o->locked_until_ns;
        o->locks++;
        o->failures = o->attacks = 0;
    }
}

/* Judges or counts one report of the appliance. */
static void hear(struct world *w, const char *news)
{
    unsigned frames = 0;
    if (strncmp(news, "visit allow ", 12) == 0) {
        judge_admission(w, news + 12);
    } else if (strncmp(news, "visit deny ", 11) == 0) {
        total.denied++;
        if (strncmp(news + 11, "unknown", 7) == 0 || strncmp(news + 11, "attack", 6) == 0) {
            note_failure(w, news[11] == 'a');
        } else if (sscanf(news + 11, "left %u", &frames) == 1 &&
                   frames >= (unsigned)w->rig->config.decision.agree) {
            note_failure(w, false);
        }
    } else if (strncmp(news, "enroll completed", 16) == 0) {
        w->oracle.carl_is_enrolled = true;
    } else if (strcmp(news, "claim lost") == 0) {
        w->oracle.claimed = false;
    }
}

/* Faults that deprive the appliance of usable frames, or of a place to write its records. */
static bool blinds(enum sim_fault fault)
{
    return fault == SIM_FAULT_SENSOR_DROP || fault == SIM_FAULT_SENSOR_CORRUPT ||
           fault == SIM_FAULT_SENSOR_FROZEN || fault == SIM_FAULT_SENSOR_BLANK ||
           fault == SIM_FAULT_SENSOR_GONE || fault == SIM_FAULT_DISK_FULL ||
           fault == SIM_FAULT_DISK_READ_ONLY;
}

/* Whether the lock may have power, because the last admission is less than unlock_ms and two frames
 * ago. */
static bool is_granted(const struct world *w)
{
    const int64_t most_ns = (w->rig->config.door.unlock_ms + 2 * FRAME_MS) * ISO_NS_PER_MS;
    return w->running && w->oracle.allowed_ns != 0 &&
           w->rig->now_ns - w->oracle.allowed_ns <= most_ns;
}

/* Judges the appliance if no frame has arrived in time for a second, counted from the start at the
 * earliest. The appliance has to report this, and the door has to be at fault. The door may stay
 * unlocked for the rest of the time of an earlier admission. */
static void judge_silence(struct world *w)
{
    struct oracle *o = &w->oracle;
    if (!w->running || w->rig->now_ns - o->sighted_ns < ISO_NS_PER_S) {
        o->silent = false;
        return;
    }
    const struct iso_appliance_status status = iso_appliance_status(w->rig->appliance);
    if (strcmp(status.sensor_state, "started") == 0) {
        world_broken(w, "reports a working sensor, and no frame has arrived");
    }
    if (status.door != ISO_DOOR_FAULT && !is_granted(w)) {
        world_broken(w, "no frame has arrived, and the door is %s",
                     iso_door_state_name(status.door));
    }
    if (o->allowed_ns >= o->sighted_ns + ISO_NS_PER_S) {
        world_broken(w, "let in a person without a frame");
    }
    total.silences += !o->silent;
    o->silent = true;
}

/* Judges a fault that has been present for at least a second. */
static void judge_fault(struct world *w, enum sim_fault fault)
{
    struct oracle *o = &w->oracle;
    if (blinds(fault) && o->allowed_ns >= o->since_ns[fault] + ISO_NS_PER_S) {
        world_broken(w, "let in although there is %s", sim_fault_name(fault));
    }
    if (fault == SIM_FAULT_SENSOR_GONE && w->running &&
        strcmp(iso_appliance_status(w->rig->appliance).sensor_state, "lost") != 0) {
        world_broken(w, "does not report that the sensor is gone");
    }
    total.lasted[fault] += !o->judged[fault];
    o->judged[fault] = true;
}

static void judge_safety(struct world *w)
{
    if (rig_relay(w->rig) && !is_granted(w)) {
        world_broken(w, "the relay has power");
    }
    judge_silence(w);
    for (int i = 0; i < SIM_FAULTS; i++) {
        const enum sim_fault fault = (enum sim_fault)i;
        if (world_is_faulty(w, fault) &&
            w->rig->now_ns - w->oracle.since_ns[fault] >= ISO_NS_PER_S) {
            judge_fault(w, fault);
        }
    }
}

void oracle_begin_step(struct world *w)
{
    for (int i = 0; i < SIM_FAULTS; i++) {
        const struct sim_fault_event *event = fault_plan_at(&w->plan, w->step, (enum sim_fault)i);
        if (event && event->first == w->step) {
            w->oracle.since_ns[i] = w->rig->now_ns;
            w->oracle.judged[i] = false;
        }
    }
}

void oracle_observe(struct world *w)
{
    char text[4096];
    (void)snprintf(text, sizeof text, "%s", rig_news(w->rig));
    for (char *rest = text, *news; (news = strsep(&rest, ";"));) {
        hear(w, news + strspn(news, " "));
    }
    /* Failed attempts of clients count, too, but the oracle does not hear of all of them. A
     * lock-out may therefore begin before the oracle expects it. */
    if (w->running && iso_appliance_status(w->rig->appliance).lockout_ns > 0) {
        w->oracle.failures = w->oracle.attacks = 0;
    }
    judge_safety(w);
}
