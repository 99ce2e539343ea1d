/* Kills a process that writes gallery, log, lock-out and keys, again and again at random moments,
 * and checks each time the files that it has left. Nobody may be lost, no deleted person may be
 * back, the log's chain must be whole, and no file may be taken for one of an earlier time.
 * usage: kill_stores [ROUNDS [SEED]]     exit status 0 if every round was correct
 *
 * The writer reports each change before it begins and after it is done. From these reports the
 * observer knows who has to be in the gallery. Only the change under way may have taken effect or
 * not. The writer is also killed while it opens the stores. */
#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "firmware/audit/audit.h"
#include "firmware/gallery/gallery.h"
#include "firmware/keys/key_ring.h"
#include "firmware/visit/lockout_file.h"
#include "tests/firmware/faults/fault_tally.h"
#include "tests/firmware/rigs/puppets.h"

enum { PEOPLE = 24, KILL_WITHIN_US = 250000, START_MAX_MS = 1000, SEGMENT_BYTES = 6000 };

enum action { ENROL, DELETE, ROTATE_GALLERY, ROTATE_LOG, CHANGE_KEY, LOCK_OUT, LOG, ACTIONS };

static const char *const action_names[ACTIONS] = {"enrolments", "deletions",   "gallery keys",
                                                  "log keys",   "master keys", "lock-outs",
                                                  "log records"};

struct stores {
    struct iso_key_ring *ring;
    struct iso_gallery *gallery;
    struct iso_audit *audit;
};

/* What the writer reports. */
struct message {
    bool done;
    uint8_t action, person;
    uint64_t sequence; /* number of the last record when the change is done */
};

/* What this run has tried so far. */
static struct {
    long kills, operations;
    bool observes; /* this is the observer, which prints these counts; the writer does not */
} total;

static char directory[64];
static int templates_of[PEOPLE]; /* the templates that must be there */
static uint64_t random_state;

static uint32_t draw(uint32_t below)
{
    random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(random_state >> 33) % below;
}

static int64_t now_ns(void *context)
{
    struct timespec time;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * INT64_C(1000000000) + time.tv_nsec;
}

static const struct iso_times times = {.monotonic = {now_ns, NULL}, .wall_ns = now_ns};

__attribute__((noreturn)) static void give_up(const char *what, const char *why)
{
    fprintf(stderr, "kill_stores: %s: %s (the stores are kept in %s)\n", what, why, directory);
    if (total.observes) {
        fault_tally_print("kills", total.kills, total.operations, 1);
    }
    exit(1);
}

static char *path_of(const char *name)
{
    static char paths[8][128];
    static int turn;
    char *path = paths[turn++ % 8];
    (void)snprintf(path, sizeof paths[0], "%s/%s", directory, name);
    return path;
}

static int open_stores(struct stores *stores, struct iso_fault *fault)
{
    const struct iso_key_place place = {.ring = path_of("keys"), .file = path_of("key")};
    *stores = (struct stores){.ring = NULL};
    int error = iso_key_ring_open(&place, &stores->ring, fault);
    const struct iso_gallery_options gallery = {.path = path_of("g.db"),
                                                .capacity = PEOPLE,
                                                .algorithm = PUPPET_ALGORITHM,
                                                .ring = stores->ring};
    const struct iso_audit_options audit = {.path = path_of("a.log"),
                                            .sync = true,
                                            .segment_bytes = SEGMENT_BYTES,
                                            .segments = 20,
                                            .ring = stores->ring};
    struct iso_lockout_file lockout;
    const int none = error ? error
                           : iso_lockout_load(path_of("lockout"), stores->ring, &lockout, fault);
    error = none == -ENOENT ? 0 : none;
    if (!error) {
        error = iso_gallery_open(&gallery, &stores->gallery, fault);
    }
    if (!error) {
        error = iso_audit_open(&audit, &times, &stores->audit, fault);
    }
    return error ? error : iso_heads_check(iso_key_ring_board(stores->ring), fault);
}

static void close_stores(struct stores *stores)
{
    iso_audit_close(stores->audit);
    iso_gallery_close(stores->gallery);
    iso_key_ring_close(stores->ring);
}

/* ---- the writer ---- */

static int enrol(struct stores *stores, uint8_t person, struct iso_fault *fault)
{
    struct iso_person entry = {.enrolled_s = 1};
    const struct iso_template tmpl = puppet_template(person + 1, PUPPET_ALGORITHM);
    (void)snprintf(entry.name, sizeof entry.name, "person %d", person);
    return iso_gallery_add(stores->gallery, &entry, &tmpl, fault);
}

static int delete_person(struct stores *stores, uint8_t person, struct iso_fault *fault)
{
    char name[32];
    (void)snprintf(name, sizeof name, "person %d", person);
    return iso_gallery_remove(stores->gallery, name, fault);
}

static int append(struct stores *stores, struct iso_fault *fault)
{
    const struct iso_audit_record record = iso_audit_record_of("x");
    return iso_audit_append(stores->audit, &record, fault);
}

static int lock_out(struct stores *stores, struct iso_fault *fault)
{
    const struct iso_lockout_record record = {.failures = 1};
    return iso_lockout_save(path_of("lockout"), stores->ring, &record, fault);
}

static int act(struct stores *stores, const struct message *message, struct iso_fault *fault)
{
    switch ((enum action)message->action) {
    case ENROL:
        return enrol(stores, message->person, fault);
    case DELETE:
        return delete_person(stores, message->person, fault);
    case ROTATE_GALLERY:
        return iso_gallery_rotate(stores->gallery, NULL, fault);
    case ROTATE_LOG:
        return iso_audit_rotate_key(stores->audit, fault);
    case CHANGE_KEY:
        return iso_key_ring_change_key(stores->ring, fault);
    case LOCK_OUT:
        return lock_out(stores, fault);
    default:
        return append(stores, fault);
    }
}

/* Chooses a change that is possible: a person with all templates is not enrolled, and a missing
 * person is not deleted. */
static struct message choose(void)
{
    static const uint8_t lots[16] = {
        ENROL,  ENROL,          ENROL,      ENROL,      ENROL,    ENROL,    DELETE, DELETE,
        DELETE, ROTATE_GALLERY, ROTATE_LOG, CHANGE_KEY, LOCK_OUT, LOCK_OUT, LOG,    LOG};
    struct message message = {.person = (uint8_t)draw(PEOPLE)};
    const int templates = templates_of[message.person];
    message.action = lots[draw(16)];
    if ((message.action == DELETE && templates == 0) ||
        (message.action == ENROL && templates == ISO_GALLERY_TEMPLATES_MAX)) {
        message.action = LOG;
    }
    return message;
}

static void keep_in_mind(const struct message *message)
{
    if (message->action == ENROL) {
        templates_of[message->person]++;
    } else if (message->action == DELETE) {
        templates_of[message->person] = 0;
    }
}

__attribute__((noreturn)) static void write_for_ever(int report_fd)
{
    struct stores stores;
    struct iso_fault fault = {.text = ""};
    if (open_stores(&stores, &fault)) {
        give_up("the writer cannot open", fault.text);
    }
    for (;;) {
        struct message message = choose();
        if (write(report_fd, &message, sizeof message) != sizeof message) {
            _exit(2);
        }
        if (act(&stores, &message, &fault)) {
            give_up(action_names[message.action], fault.text);
        }
        keep_in_mind(&message);
        message.done = true;
        message.sequence = iso_audit_last(stores.audit);
        if (write(report_fd, &message, sizeof message) != sizeof message) {
            _exit(2);
        }
    }
}

/* ---- the observer ---- */

struct tally {
    unsigned done[ACTIONS], cut[ACTIONS], cut_held;
    int64_t slowest_ns;
    uint64_t last; /* number of the last record that the log must have */
};

/* Lets a writer run for a while and kills it. Returns whether the writer had begun a change that it
 * did not report as done; *under_way is then this change. */
static bool run_writer(struct tally *tally, struct message *under_way)
{
    int fds[2], status = 0;
    struct message message;
    bool begun = false;
    const pid_t pid = pipe(fds) == 0 ? fork() : -1;
    if (pid < 0) {
        give_up("a pipe and a process", strerror(errno));
    }
    if (pid == 0) {
        (void)close(fds[0]);
        total.observes = false;
        write_for_ever(fds[1]);
    }
    (void)close(fds[1]);
    (void)usleep(draw(KILL_WITHIN_US));
    (void)kill(pid, SIGKILL);
    total.kills++;
    (void)waitpid(pid, &status, 0);
    if (!WIFSIGNALED(status) || WTERMSIG(status) != SIGKILL) {
        give_up("the writer", "it ended by itself");
    }
    while (read(fds[0], &message, sizeof message) == sizeof message) {
        begun = !message.done;
        total.operations += begun;
        *under_way = message;
        if (message.done) {
            keep_in_mind(&message);
            tally->done[message.action]++;
            tally->last = message.sequence;
        }
    }
    (void)close(fds[0]);
    return begun;
}

/* Whether a person has this number of templates. A face of another person is always an error. */
static bool is_as(const struct stores *stores, int person, int templates)
{
    char name[32];
    (void)snprintf(name, sizeof name, "person %d", person);
    const struct iso_person *found = iso_gallery_find(stores->gallery, name);
    if (!found) {
        return templates == 0;
    }
    const struct iso_candidate_list own = iso_gallery_only(stores->gallery, found->id);
    for (int i = 0; i < own.n_entries; i++) {
        if (puppet_face_of(own.entries[i].tmpl) != person + 1) {
            give_up(name, "has the template of another person");
        }
    }
    return own.n_entries == templates;
}

/* Compares the people in the gallery with the expected people. Notes the change under way if it has
 * taken effect. */
static void check_people(const struct stores *stores, const struct message *under_way,
                         struct tally *tally)
{
    size_t n = 0;
    int there = 0;
    const bool changes = under_way && under_way->action <= DELETE;
    for (int i = 0; i < PEOPLE; i++) {
        if (!is_as(stores, i, templates_of[i])) {
            if (!changes || under_way->person != i) {
                give_up("somebody", "is lost, or back after a deletion");
            }
            keep_in_mind(under_way);
            tally->cut_held++;
            if (!is_as(stores, i, templates_of[i])) {
                give_up("somebody", "is neither as before the change nor as after it");
            }
        }
        there += templates_of[i] > 0;
    }
    (void)iso_gallery_people(stores->gallery, &n);
    if ((int)n != there) {
        give_up("the gallery", "has people whom nobody enrolled");
    }
}

static void check_log(const struct stores *stores, const struct tally *tally)
{
    struct iso_audit_report report;
    struct iso_fault fault = {.text = ""};
    if (iso_audit_verify(stores->audit, 0, NULL, NULL, &report, &fault)) {
        give_up("the log", fault.text);
    }
    if (!report.sound) {
        give_up("the log", report.flaw);
    }
    if (report.last < tally->last) {
        give_up("the log", "has lost records");
    }
}

static void observe(const struct message *under_way, struct tally *tally)
{
    struct stores stores;
    struct iso_fault fault = {.text = ""};
    const int64_t start_ns = now_ns(NULL);
    if (open_stores(&stores, &fault)) {
        give_up("after a kill", fault.text);
    }
    const int64_t took_ns = now_ns(NULL) - start_ns;
    tally->slowest_ns = took_ns > tally->slowest_ns ? took_ns : tally->slowest_ns;
    check_people(&stores, under_way, tally);
    check_log(&stores, tally);
    close_stores(&stores);
}

static void print(const struct tally *tally, unsigned rounds)
{
    printf("%u kills: nobody lost, nobody back, the chain of the log whole, no file taken "
           "for an old one\n",
           rounds);
    printf("%-14s %8s %10s\n", "", "done", "cut short");
    for (int i = 0; i < ACTIONS; i++) {
        printf("%-14s %8u %10u\n", action_names[i], tally->done[i], tally->cut[i]);
    }
    printf("enrolments and deletions cut short that took effect: %u\n", tally->cut_held);
    printf("slowest start of the stores: %.0f ms\n", (double)tally->slowest_ns / 1e6);
}

static void remove_all(void)
{
    char command[128];
    (void)snprintf(command, sizeof command, "rm -r '%s'", directory);
    if (system(command)) {
        give_up("rm", command);
    }
}

int main(int argc, char **argv)
{
    const unsigned rounds = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 20;
    const char *place = getenv("TMPDIR");
    struct tally tally = {.slowest_ns = 0};
    total.observes = true;
    random_state = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    (void)snprintf(directory, sizeof directory, "%s/isotherm-kills-XXXXXX", place ? place : "/tmp");
    if (rounds == 0 || !mkdtemp(directory)) {
        fputs("usage: kill_stores [ROUNDS [SEED]]\n", stderr);
        return 2;
    }
    for (unsigned round = 0; round < rounds; round++) {
        struct message under_way;
        const bool begun = run_writer(&tally, &under_way);
        if (begun) {
            tally.cut[under_way.action]++;
        }
        observe(begun ? &under_way : NULL, &tally);
    }
    print(&tally, rounds);
    remove_all();
    const bool slow = tally.slowest_ns > START_MAX_MS * INT64_C(1000000);
    if (slow) {
        fprintf(stderr, "kill_stores: a start took more than %d ms\n", START_MAX_MS);
    }
    fault_tally_print("kills", total.kills, total.operations, slow);
    return slow;
}
