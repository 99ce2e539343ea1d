/* isotherm-screen: the screen for visitors at the door. A client of the daemon, which goes on
 * without it. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-daemon.h>
#include <systemd/sd-event.h>

#include "enroll/screen/client/client.h"
#include "enroll/screen/language/language.h"
#include "enroll/screen/painter.h"
#include "enroll/screen/speech/speech.h"

struct program {
    struct screen_painter painter;
    struct screen_speech speech;
    struct screen_client *client;
    sd_event *event;
    sd_event_source *tick;
    int64_t next_look_ns, end_ns;
};

static int64_t now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static int on_tick(sd_event_source *source, uint64_t usec, void *context)
{
    struct program *program = context;
    const struct screen_display *display = &program->painter.display;
    const int64_t now = now_ns();
    bool anew = false;
    (void)usec;
    if (display->ops->looks_often || now >= program->next_look_ns) {
        anew = display->ops->look(display->self);
        program->next_look_ns = now + 1000000000;
    }
    screen_painter_paint(&program->painter, screen_client_state(program->client), now, time(NULL),
                         anew);
    if (program->painter.drawn) {
        screen_speech_follow(&program->speech, &program->painter.shown);
    }
    if (program->end_ns && now >= program->end_ns) {
        return sd_event_exit(program->event, 0);
    }
    const int r = sd_event_source_set_time_relative(source, SCREEN_PERIOD_MS * UINT64_C(1000));
    return r < 0 ? r : sd_event_source_set_enabled(source, SD_EVENT_ONESHOT);
}

static int open_loop(struct program *program, const struct screen_options *options)
{
    sigset_t signals;
    (void)sigemptyset(&signals);
    (void)sigaddset(&signals, SIGTERM);
    (void)sigaddset(&signals, SIGINT);
    (void)sigprocmask(SIG_BLOCK, &signals, NULL);
    int r = sd_event_default(&program->event);
    r = r < 0 ? r : sd_event_add_signal(program->event, NULL, SIGTERM, NULL, NULL);
    r = r < 0 ? r : sd_event_add_signal(program->event, NULL, SIGINT, NULL, NULL);
    r = r < 0 ? r
              : screen_client_new(program->event, options->bus, options->show_names,
                                  &program->client);
    return r < 0 ? r
                 : sd_event_add_time_relative(program->event, &program->tick, CLOCK_MONOTONIC, 0, 0,
                                              on_tick, program);
}

static int open_display(const struct screen_options *options, struct screen_display *out)
{
    struct iso_fault fault = {.text = ""};
    int error;
    if (*options->png) {
        error = screen_display_png(options->png, options->width_px, options->height_px, out,
                                   &fault);
    } else if (options->window) {
        error = screen_display_window(options->width_px, options->height_px, out, &fault);
    } else {
        error = screen_display_kms(options->device, out, &fault);
    }
    if (error) {
        fprintf(stderr, "isotherm-screen: %s\n", fault.text);
    }
    return error;
}

static int run(const struct screen_options *options)
{
    struct program program = {
        .painter = {.options = options},
        .speech = {.on = options->speak, .language = options->language, .directory = options->png},
    };
    int r = open_display(options, &program.painter.display);
    if (r == 0) {
        program.end_ns = options->seconds ? now_ns() + options->seconds * INT64_C(1000000000) : 0;
        r = open_loop(&program, options);
        if (r >= 0) {
            (void)sd_notify(0, "READY=1");
            r = sd_event_loop(program.event);
        }
        if (r < 0) {
            fprintf(stderr, "isotherm-screen: %s\n", strerror(-r));
        }
    }
    screen_speech_end(&program.speech);
    screen_client_free(program.client);
    sd_event_source_disable_unref(program.tick);
    sd_event_unref(program.event);
    screen_display_close(&program.painter.display);
    return r < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
    struct screen_options options;
    const int r = screen_options_read(argc, argv, &options);
    if (r) {
        return r < 0 ? 2 : EXIT_SUCCESS;
    }
    const int error = screen_language_set(options.language, options.catalogues);
    if (error == -EINVAL) {
        fprintf(stderr, "isotherm-screen: --language %s: there are en, de, fr, es, ar, zh_CN\n",
                options.language);
        return 2;
    }
    if (error) {
        fprintf(stderr, "isotherm-screen: %s: no translation in %s; the screen is English\n",
                options.language, options.catalogues);
    }
    return run(&options);
}
