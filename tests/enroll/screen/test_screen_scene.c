/* What the screen shows in each state, and the words for it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "enroll/screen/draw/palette.h"
#include "enroll/screen/scene/scene.h"
#include "firmware/contract/status_keys.h"
#include "firmware/visit/decision.h"
#include "isotherm/capture.h"

static const int64_t second_ns = INT64_C(1000000000);

/* A daemon that watches, with nobody there. */
static struct screen_state idle(void)
{
    return (struct screen_state){.connected = true, .sees = true, .mode = "watch"};
}

/* The same with a face and this hint. */
static struct screen_state face(const char *hint, int64_t at_ns)
{
    struct screen_state state = idle();
    state.has_record = true;
    state.record_ns = at_ns;
    state.record.distance_mm = 600;
    state.record.n_points = 3;
    (void)snprintf(state.record.hint, sizeof state.record.hint, "%s", hint);
    return state;
}

static struct screen_scene show(const struct screen_state *state, int64_t now_ns)
{
    struct screen_scene_memory memory = {.hint = NULL};
    return screen_scene_of(&memory, state, now_ns);
}

static void without_a_daemon_or_a_sensor_it_is_out_of_service(void **state)
{
    (void)state;
    const struct screen_state nothing = {.connected = false};
    struct screen_state blind = idle();
    blind.sees = false;
    assert_int_equal(show(&nothing, 0).kind, SCREEN_OUT_OF_SERVICE);
    assert_int_equal(show(&blind, 0).kind, SCREEN_OUT_OF_SERVICE);
    assert_string_equal(show(&blind, 0).title, "Out of service");
}

static void nobody_sees_the_clock(void **state)
{
    (void)state;
    const struct screen_state nobody = idle();
    assert_int_equal(show(&nobody, 0).kind, SCREEN_IDLE);
    assert_null(show(&nobody, 0).title);
    const struct screen_state old = face("ok", 0);
    assert_int_equal(show(&old, second_ns / 2).kind, SCREEN_NEAR);
    assert_int_equal(show(&old, 2 * second_ns).kind, SCREEN_IDLE); /* the record is too old */
}

static void a_visit_is_shown_for_some_seconds(void **state)
{
    (void)state;
    struct screen_state visit = face("ok", 0);
    visit.has_visit = visit.allowed = true;
    (void)snprintf(visit.person, sizeof visit.person, "Ada");
    struct screen_scene scene = show(&visit, second_ns / 2);
    assert_int_equal(scene.kind, SCREEN_ALLOWED);
    assert_string_equal(scene.person, "Ada");
    assert_int_equal(scene.symbol, SCREEN_TICK);
    assert_int_equal(show(&visit, SCREEN_VISIT_NS).kind, SCREEN_IDLE);
    visit.allowed = false;
    (void)snprintf(visit.reason, sizeof visit.reason, "unknown");
    scene = show(&visit, second_ns / 2);
    assert_int_equal(scene.kind, SCREEN_REFUSED);
    assert_string_equal(scene.title, "Not recognised");
    assert_string_equal(scene.person, ""); /* whoever it was */
}

static void lockdown_and_lock_out_are_shown_after_the_visit(void **state)
{
    (void)state;
    struct screen_state closed = face("ok", 10 * second_ns);
    closed.lockdown = true;
    assert_string_equal(show(&closed, 10 * second_ns).title, "Closed");
    closed.lockdown = false;
    closed.locked_out = true;
    assert_string_equal(show(&closed, 10 * second_ns).title, "Locked");
    assert_int_equal(show(&closed, 10 * second_ns).kind, SCREEN_CLOSED);
}

static void a_client_with_the_camera_makes_visitors_wait(void **state)
{
    (void)state;
    struct screen_state busy = face("ok", 0);
    (void)snprintf(busy.mode, sizeof busy.mode, "claimed");
    assert_int_equal(show(&busy, 0).kind, SCREEN_BUSY);
    (void)snprintf(busy.mode, sizeof busy.mode, "enroll");
    assert_int_equal(show(&busy, 0).kind, SCREEN_ENROL);
    (void)snprintf(busy.record.hint, sizeof busy.record.hint, "turn-left");
    assert_string_equal(show(&busy, 0).title, "Turn your head to the left");
    assert_int_equal(show(&busy, 0).symbol, SCREEN_LEFT);
}

static void a_hint_stays_until_it_has_been_read(void **state)
{
    (void)state;
    struct screen_scene_memory memory = {.hint = NULL};
    struct screen_state near = face("too-far", 0);
    assert_string_equal(screen_scene_of(&memory, &near, 0).title, "Come closer");
    near = face("moving", second_ns);
    assert_string_equal(screen_scene_of(&memory, &near, second_ns).title, "Come closer");
    near = face("ok", second_ns + 1);
    assert_string_equal(screen_scene_of(&memory, &near, second_ns + 1).title, "Come closer");
    near = face("moving", SCREEN_HINT_NS);
    assert_string_equal(screen_scene_of(&memory, &near, SCREEN_HINT_NS).title, "Hold still");
    /* With another visitor the hint does not stay. */
    near = idle();
    assert_int_equal(screen_scene_of(&memory, &near, SCREEN_HINT_NS + 1).kind, SCREEN_IDLE);
    near = face("ok", SCREEN_HINT_NS + 2);
    assert_string_equal(screen_scene_of(&memory, &near, SCREEN_HINT_NS + 2).title,
                        "Look at the camera");
}

/* The tables cover the words of the daemon, and no others. */
static void every_word_of_the_daemon_has_its_words(void **state)
{
    (void)state;
    size_t n = 0;
    size_t known = 0;
    for (int i = 0; i < ISO_CAPTURES; i++) {
        const enum iso_capture capture = (enum iso_capture)i;
        const bool is_hint = capture != ISO_CAPTURE_OK && capture != ISO_CAPTURE_NOBODY &&
                             capture != ISO_CAPTURE_NO_FACE;
        const struct screen_words *words = screen_hint_words(iso_capture_name(capture));
        assert_int_equal(words != NULL, is_hint);
        assert_true(!words || words->symbol != SCREEN_NO_SYMBOL);
        known += is_hint;
    }
    (void)screen_all_hints(&n);
    assert_int_equal(n, known);
    known = 0;
    for (int i = 0; iso_reason_name((enum iso_reason)i); i++) {
        const char *name = iso_reason_name((enum iso_reason)i);
        const bool allows = i == ISO_REASON_MATCH || i == ISO_REASON_OPEN ||
                            i == ISO_REASON_CREDENTIAL;
        if (!allows) {
            assert_string_equal(screen_refusal_words(name)->word, name);
            assert_non_null(screen_refusal_words(name)->advice);
            known++;
        }
    }
    (void)screen_all_refusals(&n);
    assert_int_equal(n, known);
    assert_string_equal(screen_refusal_words("a word of a later version")->title, "Out of order");
}

/* The policy wants more: the words come at once, also while the last visit is still shown, and end
 * with the records. */
static void what_is_wanted_is_said(void **state)
{
    static const char *const words[] = {ISO_CONTRACT_WANTED_FACE, ISO_CONTRACT_WANTED_CARD,
                                        ISO_CONTRACT_WANTED_PIN, ISO_CONTRACT_WANTED_PERSON};
    struct screen_state waiting = face("ok", 0);
    size_t n = 0;
    (void)state;
    waiting.has_visit = true;
    waiting.visit_ns = waiting.record_ns;
    (void)screen_all_wanted(&n);
    assert_int_equal(n, sizeof words / sizeof *words);
    for (size_t i = 0; i < n; i++) {
        (void)snprintf(waiting.record.verdict, sizeof waiting.record.verdict, "wait");
        (void)snprintf(waiting.record.reason, sizeof waiting.record.reason, "%s", words[i]);
        const struct screen_scene scene = show(&waiting, waiting.record_ns);
        assert_int_equal(scene.kind, SCREEN_WANTED);
        assert_string_equal(scene.title, screen_wanted_words(words[i])->title);
        assert_true(scene.symbol != SCREEN_NO_SYMBOL);
        assert_true(show(&waiting, waiting.record_ns + 2 * SCREEN_RECORD_NS).kind != SCREEN_WANTED);
    }
    waiting.connected = false;
    assert_int_equal(show(&waiting, waiting.record_ns).kind, SCREEN_OUT_OF_SERVICE);
}

/* A text of the panel is shown while nobody is refused or let in, and before an outline. */
static void the_panel_has_its_say(void **state)
{
    struct screen_state panel = face("ok", 0);
    (void)state;
    (void)snprintf(panel.panel_text, sizeof panel.panel_text, "USE CARD");
    (void)snprintf(panel.panel_lamp, sizeof panel.panel_lamp, "red");
    const struct screen_scene scene = show(&panel, 0);
    assert_int_equal(scene.kind, SCREEN_PANEL);
    assert_string_equal(scene.person, "USE CARD");
    assert_int_equal(scene.symbol, SCREEN_CROSS);
    panel.has_visit = panel.allowed = true;
    assert_int_equal(show(&panel, 0).kind, SCREEN_ALLOWED);
    panel.has_visit = false;
    panel.lockdown = true;
    assert_int_equal(show(&panel, 0).kind, SCREEN_CLOSED);
    panel.lockdown = false;
    (void)snprintf(panel.mode, sizeof panel.mode, "claimed");
    assert_int_equal(show(&panel, 0).kind, SCREEN_BUSY);
}

static void every_colour_is_readable(void **state)
{
    (void)state;
    for (int i = 0; i < SCREEN_SCENES; i++) {
        const struct screen_palette p = screen_palette_of((enum screen_scene_kind)i);
        assert_true(screen_contrast(p.text, p.ground) >= 7.0);
        assert_true(screen_contrast(p.accent, p.ground) >= 7.0);
        assert_true(screen_contrast(p.quiet, p.ground) >= 7.0);
        assert_non_null(screen_scene_name((enum screen_scene_kind)i));
    }
    const struct screen_colour black = {0, 0, 0};
    const struct screen_colour white = {1, 1, 1};
    assert_true(screen_contrast(black, white) > 20.9 && screen_contrast(white, black) < 21.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_daemon_or_a_sensor_it_is_out_of_service),
        cmocka_unit_test(nobody_sees_the_clock),
        cmocka_unit_test(a_visit_is_shown_for_some_seconds),
        cmocka_unit_test(lockdown_and_lock_out_are_shown_after_the_visit),
        cmocka_unit_test(a_client_with_the_camera_makes_visitors_wait),
        cmocka_unit_test(a_hint_stays_until_it_has_been_read),
        cmocka_unit_test(every_word_of_the_daemon_has_its_words),
        cmocka_unit_test(what_is_wanted_is_said),
        cmocka_unit_test(the_panel_has_its_say),
        cmocka_unit_test(every_colour_is_readable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
