/* The voice of the screen: what is spoken, in which order, and that it is sound. It needs
 * espeak-ng. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "enroll/screen/language/language.h"
#include "enroll/screen/speech/speech.h"
#include "tests/support/scratch.h"

#define CATALOGUES ISOTHERM_BINARY_DIR "/enroll/screen/locale"
enum { WAIT_MS = 20000, LOOK_MS = 10, HEADER_BYTES = 44, SKIPPED = 77 };

static const char *directory;

static int setup(void **state)
{
    const int failed = scratch_setup(state);
    directory = *state;
    return failed;
}

static struct screen_scene near(const char *title)
{
    return (struct screen_scene){.kind = SCREEN_NEAR, .title = title};
}

static struct screen_scene refused(void)
{
    return (struct screen_scene){.kind = SCREEN_REFUSED,
                                 .title = "Not recognised",
                                 .advice = "Please use your card or ask for help"};
}

/* Goes on until nothing is being spoken. */
static void wait_for_silence(struct screen_speech *speech, const struct screen_scene *scene)
{
    const struct timespec look = {.tv_nsec = LOOK_MS * 1000000L};
    for (int waited_ms = 0; waited_ms < WAIT_MS; waited_ms += LOOK_MS) {
        screen_speech_follow(speech, scene);
        if (!speech->child) {
            return;
        }
        (void)nanosleep(&look, NULL);
    }
    fail_msg("espeak-ng did not end");
}

/* The size of a sound file, after checking that it is one and that it is not silent. */
static size_t size_of_sound(unsigned n)
{
    static uint8_t bytes[4 << 20];
    char path[600];
    long loudest = 0;
    (void)snprintf(path, sizeof path, "%s/%05u.wav", directory, n);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    (void)fclose(file);
    assert_true(size > HEADER_BYTES);
    assert_memory_equal(bytes, "RIFF", 4);
    for (size_t i = HEADER_BYTES; i + 1 < size; i += 2) {
        const long sample = (int16_t)(bytes[i] | bytes[i + 1] << 8);
        loudest = labs(sample) > loudest ? labs(sample) : loudest;
    }
    assert_true(loudest > 3000);
    return size;
}

static void every_language_has_a_voice(void **state)
{
    (void)state;
    for (const char *const *language = screen_languages; *language; language++) {
        struct screen_speech speech = {.on = true, .language = *language, .directory = directory};
        const struct screen_scene scene = refused();
        assert_int_equal(screen_language_set(*language, CATALOGUES), 0);
        wait_for_silence(&speech, &scene);
        assert_true(speech.on);
        assert_int_equal(speech.n, 1);
        print_message("%s: %zu bytes of sound\n", *language, size_of_sound(0));
    }
    assert_int_equal(screen_language_set("en", CATALOGUES), 0);
}

static void words_are_spoken_once(void **state)
{
    struct screen_speech speech = {.on = true, .language = "en", .directory = directory};
    struct screen_scene scene = near("Come closer");
    (void)state;
    wait_for_silence(&speech, &scene);
    wait_for_silence(&speech, &scene);
    assert_int_equal(speech.n, 1);
    const size_t title_alone = size_of_sound(0);
    scene = refused();
    wait_for_silence(&speech, &scene);
    assert_int_equal(speech.n, 2);
    assert_true(size_of_sound(1) > title_alone); /* the advice is spoken, too */
    /* Somebody else comes after nobody was there: the same words are said again. */
    scene = (struct screen_scene){.kind = SCREEN_IDLE};
    wait_for_silence(&speech, &scene);
    scene = refused();
    wait_for_silence(&speech, &scene);
    assert_int_equal(speech.n, 3);
}

static void a_hint_waits_and_a_verdict_does_not(void **state)
{
    struct screen_speech speech = {.on = true, .language = "en", .directory = directory};
    const struct screen_scene closer = near("Come closer");
    const struct screen_scene back = near("Step back a little");
    const struct screen_scene verdict = refused();
    (void)state;
    screen_speech_follow(&speech, &closer);
    const pid_t first = speech.child;
    assert_true(first > 0);
    screen_speech_follow(&speech, &back); /* at once: the first words are still being spoken */
    assert_int_equal(speech.child, first);
    assert_int_equal(speech.n, 1);
    screen_speech_follow(&speech, &verdict);
    assert_int_equal(speech.n, 2);
    assert_true(speech.child > 0 && speech.child != first);
    screen_speech_end(&speech);
    assert_int_equal(speech.child, 0);
}

static void it_is_off_unless_asked_for(void **state)
{
    struct screen_speech speech = {.language = "en", .directory = directory};
    const struct screen_scene verdict = refused();
    (void)state;
    screen_speech_follow(&speech, &verdict);
    assert_int_equal(speech.n, 0);
}

static void without_espeak_it_switches_itself_off(void **state)
{
    struct screen_speech speech = {.on = true, .language = "en", .directory = directory};
    const struct screen_scene verdict = refused();
    char before[4096];
    (void)state;
    (void)snprintf(before, sizeof before, "%s", getenv("PATH"));
    assert_int_equal(setenv("PATH", directory, 1), 0);
    screen_speech_follow(&speech, &verdict);
    assert_int_equal(setenv("PATH", before, 1), 0);
    assert_false(speech.on);
    assert_int_equal(speech.child, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_language_has_a_voice),
        cmocka_unit_test(words_are_spoken_once),
        cmocka_unit_test(a_hint_waits_and_a_verdict_does_not),
        cmocka_unit_test(it_is_off_unless_asked_for),
        cmocka_unit_test(without_espeak_it_switches_itself_off),
    };
    if (access("/usr/bin/espeak-ng", X_OK)) {
        puts("skipped: espeak-ng is not installed");
        return SKIPPED;
    }
    return cmocka_run_group_tests(tests, setup, scratch_teardown);
}
