#include "enroll/screen/scene/scene.h"

#include <stdio.h>
#include <string.h>

#include "firmware/contract/status_keys.h"

const char *screen_scene_name(enum screen_scene_kind kind)
{
    static const char *const names[SCREEN_SCENES] = {
        "out-of-service", "wanted", "allowed", "refused", "closed",
        "enrol",          "busy",   "panel",   "near",    "idle",
    };
    return kind >= 0 && kind < SCREEN_SCENES ? names[kind] : NULL;
}

static struct screen_scene of_words(enum screen_scene_kind kind, const char *title,
                                    const char *advice, enum screen_symbol symbol)
{
    return (struct screen_scene){.kind = kind, .title = title, .advice = advice, .symbol = symbol};
}

static bool has_face(const struct screen_state *state, int64_t now_ns)
{
    return state->has_record && now_ns - state->record_ns < SCREEN_RECORD_NS &&
           state->record.distance_mm > 0;
}

static bool shows_visit(const struct screen_state *state, int64_t now_ns)
{
    return state->has_visit && now_ns - state->visit_ns < SCREEN_VISIT_NS;
}

static struct screen_scene of_visit(const struct screen_state *state)
{
    if (!state->allowed) {
        const struct screen_words *words = screen_refusal_words(state->reason);
        return of_words(SCREEN_REFUSED, words->title, words->advice, words->symbol);
    }
    struct screen_scene scene = of_words(SCREEN_ALLOWED, N_("Welcome"), N_("The door is open"),
                                         SCREEN_TICK);
    (void)snprintf(scene.person, sizeof scene.person, "%s", state->person);
    return scene;
}

/* What the policy wants besides, by a record that still counts; NULL: nothing. */
static const struct screen_words *wanted_now(const struct screen_state *state, int64_t now_ns)
{
    const bool waits = state->connected && state->sees && state->has_record &&
                       now_ns - state->record_ns < SCREEN_RECORD_NS &&
                       strcmp(state->record.verdict, ISO_CONTRACT_VERDICT_WAIT) == 0;
    return waits ? screen_wanted_words(state->record.reason) : NULL;
}

static struct screen_scene of_closed(const struct screen_state *state)
{
    const struct screen_words *words = screen_refusal_words(state->lockdown ? "lockdown"
                                                                            : "locked-out");
    return of_words(SCREEN_CLOSED, words->title, words->advice, words->symbol);
}

/* The hint to show: the present one, or the last one as long as it has not been read. */
static const struct screen_words *hold_hint(struct screen_scene_memory *memory,
                                            const struct screen_words *hint, int64_t now_ns)
{
    if (hint == memory->hint) {
        return hint;
    }
    if (!memory->hint || now_ns - memory->since_ns >= SCREEN_HINT_NS) {
        memory->hint = hint;
        memory->since_ns = now_ns;
    }
    return memory->hint;
}

static struct screen_scene of_face(struct screen_scene_memory *memory,
                                   const struct screen_state *state, int64_t now_ns, bool enrols)
{
    const bool face = has_face(state, now_ns);
    const struct screen_words *hint = hold_hint(
        memory, face || enrols ? screen_hint_words(state->record.hint) : NULL, now_ns);
    struct screen_scene scene = of_words(
        enrols ? SCREEN_ENROL : SCREEN_NEAR, N_("Look at the camera"),
        enrols ? N_("You are being enrolled") : NULL, SCREEN_NO_SYMBOL);
    if (hint) {
        scene.title = hint->title;
        scene.symbol = hint->symbol;
    }
    if (face) {
        scene.outline = state->record;
    }
    return scene;
}

/* The text of the access panel, with a symbol for the colour of its lamp. */
static struct screen_scene of_panel(const struct screen_state *state)
{
    static const struct {
        const char *lamp;
        enum screen_symbol symbol;
    } lamps[] = {{"red", SCREEN_CROSS}, {"green", SCREEN_TICK}, {"amber", SCREEN_CLOCK}};
    struct screen_scene scene = of_words(SCREEN_PANEL, N_("From the access panel"), NULL,
                                         SCREEN_NO_SYMBOL);
    for (size_t i = 0; i < sizeof lamps / sizeof *lamps; i++) {
        if (strcmp(state->panel_lamp, lamps[i].lamp) == 0) {
            scene.symbol = lamps[i].symbol;
        }
    }
    (void)snprintf(scene.person, sizeof scene.person, "%s", state->panel_text);
    return scene;
}

struct screen_scene screen_scene_of(struct screen_scene_memory *memory,
                                    const struct screen_state *state, int64_t now_ns)
{
    const bool enrols = strcmp(state->mode, "enroll") == 0;
    const bool busy = *state->mode && strcmp(state->mode, "watch") != 0;
    const struct screen_words *wanted = wanted_now(state, now_ns);
    if (wanted) {
        *memory = (struct screen_scene_memory){.hint = NULL};
        return of_words(SCREEN_WANTED, wanted->title, wanted->advice, wanted->symbol);
    }
    if (state->connected && state->sees && !shows_visit(state, now_ns) && !state->lockdown &&
        !state->locked_out &&
        (enrols || (!busy && !*state->panel_text && has_face(state, now_ns)))) {
        return of_face(memory, state, now_ns, enrols);
    }
    *memory = (struct screen_scene_memory){.hint = NULL};
    if (!state->connected || !state->sees) {
        return of_words(SCREEN_OUT_OF_SERVICE, N_("Out of service"),
                        N_("Please use your key or ask for help"), SCREEN_WRENCH);
    }
    if (shows_visit(state, now_ns)) {
        return of_visit(state);
    }
    if (state->lockdown || state->locked_out) {
        return of_closed(state);
    }
    if (!busy && *state->panel_text) {
        return of_panel(state);
    }
    return busy ? of_words(SCREEN_BUSY, N_("One moment, please"), NULL, SCREEN_CLOCK)
                : of_words(SCREEN_IDLE, NULL, N_("Look at the camera to enter"), SCREEN_NO_SYMBOL);
}
