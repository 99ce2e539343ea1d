#include "drivers/terminal/progress.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "drivers/process/thread.h"
#include "drivers/terminal/terminal.h"
#include "drivers/terminal/words.h"

enum { TEXT_SIZE = 512 };

static const int64_t second_ns = 1000000000;
static const int64_t tick_ns = 200000000;
static const int64_t first_line_ns = 2000000000;
static const int64_t next_line_ns = 10000000000;

struct iso_progress {
    struct iso_terminal terminal;
    const char *program;
    struct iso_clock clock;
    pthread_mutex_t lock; /* protects all members below */
    pthread_cond_t change;
    pthread_t thread;
    bool ticking, ending;
    struct iso_progress_view view;
    int64_t started_ns;
    int64_t line_ns; /* when the next plain line is due, measured from the start */
    bool drawn;      /* the terminal shows the line */
};

static int64_t system_now_ns(void *context)
{
    struct timespec now;

    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * second_ns + now.tv_nsec;
}

static void erase_bar(struct iso_progress *progress)
{
    if (progress->drawn) {
        fputs("\r\033[K", progress->terminal.out);
        (void)fflush(progress->terminal.out);
        progress->drawn = false;
    }
}

static void draw_bar(struct iso_progress *progress)
{
    char text[TEXT_SIZE];

    iso_progress_bar(&progress->view, progress->terminal.columns, text, sizeof text);
    fprintf(progress->terminal.out, "\r\033[K%s", text);
    (void)fflush(progress->terminal.out);
    progress->drawn = true;
}

static void print_line(struct iso_progress *progress)
{
    char text[TEXT_SIZE];

    iso_progress_line(&progress->view, text, sizeof text);
    fprintf(progress->terminal.out, "%s: %s\n", progress->program, text);
    (void)fflush(progress->terminal.out);
    progress->line_ns = progress->view.elapsed_ns + next_line_ns;
}

/* Draws what is due. The lock is held. */
static void draw_due(struct iso_progress *progress)
{
    progress->view.elapsed_ns = iso_clock_now_ns(&progress->clock) - progress->started_ns;
    if (progress->terminal.is_terminal) {
        draw_bar(progress);
    } else if (progress->view.elapsed_ns >= progress->line_ns) {
        print_line(progress);
    }
}

static void *tick_on(void *context)
{
    struct iso_progress *progress = context;

    pthread_mutex_lock(&progress->lock);
    while (!progress->ending) {
        const int64_t until_ns = system_now_ns(NULL) + tick_ns;
        const struct timespec until = {until_ns / second_ns, until_ns % second_ns};
        (void)pthread_cond_clockwait(&progress->change, &progress->lock, CLOCK_MONOTONIC, &until);
        if (!progress->ending) {
            draw_due(progress);
        }
    }
    pthread_mutex_unlock(&progress->lock);
    return NULL;
}

static bool start_ticking(struct iso_progress *progress)
{
    progress->ticking = iso_thread_start(&progress->thread, tick_on, progress) == 0;
    return progress->ticking;
}

struct iso_progress *iso_progress_start(FILE *out, const char *program, const char *what,
                                        uint64_t total, const struct iso_clock *clock)
{
    static const struct iso_clock system_clock = {system_now_ns, NULL};
    struct iso_progress *progress = calloc(1, sizeof *progress);

    if (!progress) {
        return NULL;
    }
    progress->terminal = iso_terminal_of(out);
    progress->program = program;
    progress->clock = clock ? *clock : system_clock;
    progress->view = (struct iso_progress_view){.what = what, .total = total};
    progress->started_ns = iso_clock_now_ns(&progress->clock);
    progress->line_ns = first_line_ns;
    pthread_mutex_init(&progress->lock, NULL);
    pthread_cond_init(&progress->change, NULL);
    draw_due(progress);
    if (!clock && !start_ticking(progress)) {
        iso_progress_end(progress);
        return NULL;
    }
    return progress;
}

void iso_progress_step(struct iso_progress *progress, uint64_t n)
{
    if (progress) {
        pthread_mutex_lock(&progress->lock);
        progress->view.done += n;
        pthread_mutex_unlock(&progress->lock);
    }
}

void iso_progress_set(struct iso_progress *progress, uint64_t done, uint64_t total)
{
    if (progress) {
        pthread_mutex_lock(&progress->lock);
        progress->view.done = done;
        progress->view.total = total;
        pthread_mutex_unlock(&progress->lock);
    }
}

void iso_progress_pause(struct iso_progress *progress)
{
    if (progress) {
        pthread_mutex_lock(&progress->lock);
        erase_bar(progress);
    }
}

void iso_progress_resume(struct iso_progress *progress)
{
    if (progress) {
        draw_due(progress);
        pthread_mutex_unlock(&progress->lock);
    }
}

void iso_progress_tick(struct iso_progress *progress)
{
    if (progress) {
        pthread_mutex_lock(&progress->lock);
        draw_due(progress);
        pthread_mutex_unlock(&progress->lock);
    }
}

static void stop_ticking(struct iso_progress *progress)
{
    pthread_mutex_lock(&progress->lock);
    progress->ending = true;
    pthread_cond_signal(&progress->change);
    pthread_mutex_unlock(&progress->lock);
    (void)pthread_join(progress->thread, NULL);
}

void iso_progress_end(struct iso_progress *progress)
{
    char duration[ISO_DURATION_SIZE];

    if (!progress) {
        return;
    }
    if (progress->ticking) {
        stop_ticking(progress);
    }
    erase_bar(progress);
    if (progress->line_ns != first_line_ns) {
        const int64_t elapsed_ns = iso_clock_now_ns(&progress->clock) - progress->started_ns;
        iso_duration_text(elapsed_ns / second_ns, duration);
        fprintf(progress->terminal.out, "%s: %s: ended after %s\n", progress->program,
                progress->view.what, duration);
    }
    pthread_cond_destroy(&progress->change);
    pthread_mutex_destroy(&progress->lock);
    free(progress);
}
