#include "enroll/screen/speech/speech.h"

#include <errno.h>
#include <fcntl.h>
#include <libintl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* The voice of espeak-ng for a language of the screen. */
static const char *voice_of(const char *language)
{
    return strcmp(language, "zh_CN") == 0 ? "cmn" : language;
}

/* Whether these words may interrupt others. */
static bool is_urgent(enum screen_scene_kind kind)
{
    return kind == SCREEN_WANTED || kind == SCREEN_ALLOWED || kind == SCREEN_REFUSED ||
           kind == SCREEN_CLOSED;
}

static bool is_speaking(struct screen_speech *speech)
{
    if (speech->child && waitpid(speech->child, NULL, WNOHANG) != 0) {
        speech->child = 0;
    }
    return speech->child != 0;
}

void screen_speech_end(struct screen_speech *speech)
{
    if (is_speaking(speech)) {
        (void)kill(speech->child, SIGKILL);
        (void)waitpid(speech->child, NULL, 0);
        speech->child = 0;
    }
}

/* The program has blocked SIGTERM and SIGINT for its event loop; the child gets the usual mask. */
static int start(char *const argv[], pid_t *child)
{
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t none;
    (void)sigemptyset(&none);
    int error = posix_spawn_file_actions_init(&files);
    if (error) {
        return error;
    }
    error = posix_spawnattr_init(&attributes);
    if (error == 0) {
        (void)posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        (void)posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        (void)posix_spawnattr_setsigmask(&attributes, &none);
        (void)posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
        error = posix_spawnp(child, argv[0], &files, &attributes, argv, environ);
        (void)posix_spawnattr_destroy(&attributes);
    }
    (void)posix_spawn_file_actions_destroy(&files);
    return error;
}

static void speak(struct screen_speech *speech, const struct screen_scene *scene)
{
    char words[512];
    char file[PATH_MAX];
    char program[] = "espeak-ng";
    char to_file[] = "-w";
    char with_voice[] = "-v";
    char voice[16];
    char *argv[8] = {program, with_voice, voice};
    int n = 3;
    (void)snprintf(voice, sizeof voice, "%s", voice_of(speech->language));
    (void)snprintf(words, sizeof words, "%s. %s", gettext(scene->title),
                   scene->advice ? gettext(scene->advice) : "");
    if (*speech->directory) {
        (void)snprintf(file, sizeof file, "%s/%05u.wav", speech->directory, speech->n);
        argv[n++] = to_file;
        argv[n++] = file;
    }
    argv[n++] = words;
    argv[n] = NULL;
    const int error = start(argv, &speech->child);
    if (error) {
        fprintf(stderr, "isotherm-screen: --speak: %s: %s\n", program, strerror(error));
        speech->child = 0;
        speech->on = false;
    }
    speech->n++;
}

void screen_speech_follow(struct screen_speech *speech, const struct screen_scene *scene)
{
    const bool silent = scene->kind == SCREEN_IDLE || scene->kind == SCREEN_BUSY ||
                        scene->kind == SCREEN_OUT_OF_SERVICE || !scene->title;
    if (!speech->on) {
        return;
    }
    if (silent) {
        speech->said = NULL;
        (void)is_speaking(speech);
        return;
    }
    if (speech->said == scene->title) {
        (void)is_speaking(speech);
        return;
    }
    if (is_urgent(scene->kind)) {
        screen_speech_end(speech);
    }
    if (!is_speaking(speech)) {
        speak(speech, scene);
        speech->said = scene->title;
    }
}
