/* What the gallery does when its file is not what it should be, and when it is killed. */
#include <errno.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/child_end.h"
#include "tests/support/scratch.h"

enum { CAPACITY = 1000 };

static int try_open(const char *directory, struct iso_gallery **out, struct iso_fault *fault)
{
    struct iso_gallery_options options = stores_gallery(directory);
    options.capacity = CAPACITY;
    return iso_gallery_open(&options, out, fault);
}

static struct iso_gallery *open_gallery(const char *directory)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    if (try_open(directory, &gallery, &fault)) {
        fail_msg("%s", fault.text);
    }
    return gallery;
}

static int add(struct iso_gallery *gallery, int number, struct iso_fault *fault)
{
    struct iso_person person = {.enrolled_s = 1};
    const struct iso_template tmpl = puppet_template(number, PUPPET_ALGORITHM);
    (void)snprintf(person.name, sizeof person.name, "person %d", number);
    return iso_gallery_add(gallery, &person, &tmpl, fault);
}

static void make_gallery(const char *directory, int people)
{
    struct iso_gallery *gallery = open_gallery(directory);
    for (int i = 0; i < people; i++) {
        assert_int_equal(add(gallery, i, NULL), 0);
    }
    iso_gallery_close(gallery);
}

/* It is refused with this error and text, and is afterwards what it was. */
static void expect_refusal(const char *directory, int error, const char *text)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    size_t size_before = 0, size_after = 0;
    void *before = scratch_read(scratch_path(directory, "g.db"), &size_before);
    assert_int_equal(try_open(directory, &gallery, &fault), error);
    if (!strstr(fault.text, text) || !strstr(fault.text, "/g.db: ")) {
        fail_msg("'%s' does not say '%s'", fault.text, text);
    }
    assert_null(gallery);
    void *after = scratch_read(scratch_path(directory, "g.db"), &size_after);
    assert_int_equal(size_after, size_before);
    assert_memory_equal(after, before, size_before);
    free(before);
    free(after);
}

static void execute(const char *directory, const char *sql)
{
    sqlite3 *db = NULL;
    assert_int_equal(sqlite3_open(scratch_path(directory, "g.db"), &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

/* ---- files that are no gallery ---- */

static void an_empty_file_is_a_lost_gallery(void **state)
{
    scratch_write_text(scratch_path(*state, "g.db"), "");
    expect_refusal(*state, -EBADMSG, "damaged (the file is empty); put a copy in its place");
}

static void text_is_no_gallery(void **state)
{
    char text[2000];
    memset(text, 'x', sizeof text);
    scratch_write(scratch_path(*state, "g.db"), text, sizeof text);
    expect_refusal(*state, -EMEDIUMTYPE, "no gallery, or its beginning is damaged");
}

static void a_directory_is_no_gallery(void **state)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    scratch_mkdir(scratch_path(*state, "g.db"));
    assert_int_equal(try_open(*state, &gallery, &fault), -EMEDIUMTYPE);
    assert_non_null(strstr(fault.text, "not a file"));
}

static void a_database_of_others_is_no_gallery(void **state)
{
    execute(*state, "CREATE TABLE person (id INTEGER); PRAGMA user_version = 1;");
    expect_refusal(*state, -EMEDIUMTYPE, "a database of another application");
}

static void a_newer_gallery_is_left_alone(void **state)
{
    make_gallery(*state, 2);
    execute(*state, "PRAGMA user_version = 3");
    expect_refusal(*state, -EPROTONOSUPPORT, "of version 3, this program knows version 2");
}

static void wants_its_directory(void **state)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    struct iso_gallery_options options = stores_gallery(*state);
    options.path = "/nonexistent/g.db";
    assert_int_equal(iso_gallery_open(&options, &gallery, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "/nonexistent/g.db.new: No such file or directory"));
}

/* ---- damage ---- */

static void cut_short_anywhere_it_is_refused(void **state)
{
    size_t size = 0;
    make_gallery(*state, 12);
    char *whole = scratch_read(scratch_path(*state, "g.db"), &size);
    for (size_t length = 100; length < size; length += 1500) {
        struct iso_gallery *gallery = NULL;
        struct iso_fault fault = {.text = ""};
        scratch_write(scratch_path(*state, "g.db"), whole, length);
        const int error = try_open(*state, &gallery, &fault);
        if (error != -EBADMSG && error != -EMEDIUMTYPE) {
            fail_msg("cut at %zu of %zu: %d %s", length, size, error, fault.text);
        }
    }
    scratch_write(scratch_path(*state, "g.db"), whole, size);
    iso_gallery_close(open_gallery(*state));
    free(whole);
}

/* Every byte of every template is under its checksum, every page under the integrity check or the
 * schema; what is changed is either found, or was free. Never a crash, never another template. */
static void changed_anywhere_it_lies_never(void **state)
{
    size_t size = 0;
    int refused = 0;
    make_gallery(*state, 4);
    char *whole = scratch_read(scratch_path(*state, "g.db"), &size);
    for (size_t at = 0; at < size; at += 61) {
        struct iso_gallery *gallery = NULL;
        whole[at] ^= 0x20;
        scratch_write(scratch_path(*state, "g.db"), whole, size);
        whole[at] ^= 0x20;
        if (try_open(*state, &gallery, NULL)) {
            refused++;
            continue;
        }
        const struct iso_candidate_list all = iso_gallery_everybody(gallery);
        for (int i = 0; i < all.n_entries; i++) {
            const int face = puppet_face_of(all.entries[i].tmpl);
            const struct iso_template wanted = puppet_template(face, PUPPET_ALGORITHM);
            assert_memory_equal(all.entries[i].tmpl, &wanted, sizeof wanted);
        }
        iso_gallery_close(gallery);
    }
    assert_true(refused > 20);
    free(whole);
}

static void a_damaged_template_is_refused(void **state)
{
    make_gallery(*state, 2);
    execute(*state, "UPDATE template SET record = zeroblob(length(record)) WHERE id = 4");
    expect_refusal(*state, -EBADMSG, "damaged (the record of template 4 is not what was stored)");
}

static void a_template_without_a_person_is_refused(void **state)
{
    make_gallery(*state, 2);
    execute(*state, "PRAGMA foreign_keys = OFF; DELETE FROM person WHERE id = 3");
    expect_refusal(*state, -EBADMSG, "damaged (a template belongs to nobody)");
}

/* ---- other processes, rights, space ---- */

static void one_process_has_it(void **state)
{
    struct iso_gallery *gallery = open_gallery(*state), *second = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(try_open(*state, &second, &fault), -EBUSY);
    assert_non_null(strstr(fault.text, "another process uses it"));
    iso_gallery_close(gallery);
}

/* Runs `child` in a process of its own, which ends with its result. */
static int in_child(int (*child)(const char *directory), const char *directory)
{
    int status = 0;
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        _exit(child(directory));
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return child_code(status);
}

/* Root obeys file modes from here on, as everybody else does. (To become another user would not do:
 * that one may not even reach the directory.) */
static int obey_modes(void)
{
    struct __user_cap_header_struct header = {.version = _LINUX_CAPABILITY_VERSION_3};
    struct __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3];
    if (syscall(SYS_capget, &header, data)) {
        return -errno;
    }
    data[0].effective &= ~(1U << CAP_DAC_OVERRIDE | 1U << CAP_DAC_READ_SEARCH);
    return syscall(SYS_capset, &header, data) ? -errno : 0;
}

static int open_obediently(const char *directory)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    if (obey_modes()) {
        return 99;
    }
    const int error = try_open(directory, &gallery, &fault);
    return strstr(fault.text, "cannot be written") ? -error : 98;
}

static void read_only_it_is_refused(void **state)
{
    make_gallery(*state, 1);
    assert_int_equal(chmod(*state, 0555), 0);
    assert_int_equal(chmod(scratch_path(*state, "g.db"), 0444), 0);
    child_expect_code("a daemon that may only read", in_child(open_obediently, *state), EROFS, NULL,
                      NULL);
    assert_int_equal(chmod(*state, 0755), 0);
}

/* Adds people until the file may not grow any more. */
static int fill_up(const char *directory)
{
    struct iso_fault fault = {.text = ""};
    struct iso_gallery *gallery = open_gallery(directory);
    const struct rlimit limit = {60000, 60000};
    int added = 0, error;
    if (signal(SIGXFSZ, SIG_IGN) == SIG_ERR || setrlimit(RLIMIT_FSIZE, &limit)) {
        return 99;
    }
    while ((error = add(gallery, added, &fault)) == 0) {
        added++;
    }
    if (error != -ENOSPC ||
        !strstr(fault.text, "the disk refused: No space left on device; nothing was changed")) {
        fprintf(stderr, "%d %s\n", error, fault.text);
        return 98;
    }
    /* In memory it is as before, too, and works on. */
    size_t n = 0;
    (void)iso_gallery_people(gallery, &n);
    if ((int)n != added || iso_gallery_remove(gallery, "person 0", &fault)) {
        return 97;
    }
    return added;
}

static void a_full_disk_changes_nothing(void **state)
{
    size_t n = 0;
    const int added = in_child(fill_up, *state);
    assert_in_range(added, 3, 90);
    struct iso_gallery *gallery = open_gallery(*state);
    const struct iso_person *people = iso_gallery_people(gallery, &n);
    assert_int_equal(n, added - 1);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(people[i].usable, 1);
    }
    iso_gallery_close(gallery);
}

/* ---- kills ---- */

/* Adds and deletes for ever, saying each time what it has done. */
static void write_for_ever(const char *directory, int report_fd)
{
    struct iso_gallery *gallery = NULL;
    if (try_open(directory, &gallery, NULL)) {
        _exit(1);
    }
    for (int i = 0;; i++) {
        char name[32];
        (void)snprintf(name, sizeof name, "person %d", i - 3);
        if (add(gallery, i, NULL) || write(report_fd, "+", 1) != 1) {
            _exit(2);
        }
        if (i >= 3 && (iso_gallery_remove(gallery, name, NULL) || write(report_fd, "-", 1) != 1)) {
            _exit(3);
        }
    }
}

/* Kills a writer after it has reported `reports` changes, and a little. Returns how many it had
 * reported in the end. */
static int kill_a_writer(const char *directory, int reports)
{
    int fds[2], status = 0, n = 0;
    char byte;
    assert_int_equal(pipe(fds), 0);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        (void)close(fds[0]);
        write_for_ever(directory, fds[1]);
    }
    (void)close(fds[1]);
    while (n < reports && read(fds[0], &byte, 1) == 1) {
        n++;
    }
    for (volatile int spin = 0; spin < 20000 * (reports % 7); spin++) {
    }
    assert_int_equal(kill(pid, SIGKILL), 0);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFSIGNALED(status));
    while (read(fds[0], &byte, 1) == 1) {
        n++;
    }
    (void)close(fds[0]);
    return n;
}

/* How many people there are after that many changes: + + + + - + - + - ... */
static size_t people_after(int changes)
{
    if (changes <= 3) {
        return (size_t)changes;
    }
    return changes % 2 == 0 ? 4 : 3;
}

static void survives_kills(void **state)
{
    for (int round = 0; round < 8; round++) {
        size_t n = 0;
        (void)unlink(scratch_path(*state, "g.db"));
        (void)unlink(scratch_path(*state, "g.db-journal"));
        (void)unlink(scratch_path(*state, "g.db.anchor"));
        const int changes = kill_a_writer(*state, round % 12);
        struct iso_gallery *gallery = open_gallery(*state);
        const struct iso_person *people = iso_gallery_people(gallery, &n);
        /* What was reported is there; one more change may be. */
        if (n != people_after(changes) && n != people_after(changes + 1)) {
            fail_msg("after %d changes there are %zu people", changes, n);
        }
        for (size_t i = 0; i < n; i++) {
            assert_int_equal(people[i].usable, 1);
        }
        assert_int_equal(add(gallery, 500, NULL), 0);
        iso_gallery_close(gallery);
    }
}

/* ---- a record that changes while the gallery is open ---- */

/* More than what SQLite keeps of the file in memory, so that the first record is read once
 * more. */
enum { MORE_THAN_KEPT = 900, PART = 64 };

static void add_whole_faces(const char *directory)
{
    enum { BATCH = 100 };
    static struct iso_gallery_item items[BATCH];
    static uint8_t bytes[BATCH][ISO_TEMPLATE_BYTES_MAX];
    struct iso_gallery *gallery = open_gallery(directory);
    for (int i = 0; i < MORE_THAN_KEPT; i++) {
        struct iso_gallery_item *item = &items[i % BATCH];
        struct iso_template tmpl = puppet_template(i, PUPPET_ALGORITHM);
        size_t added = 0;
        for (int k = 0; k < ISO_UPPER_ROWS * ISO_UPPER_COLUMNS; k++) {
            const int row = k / ISO_UPPER_COLUMNS, column = k % ISO_UPPER_COLUMNS;
            tmpl.upper.z_mm[row][column] = (float)(k % 50 - i % 7);
            tmpl.upper.kind[row][column] = ISO_UPPER_MEASURED;
        }
        const int size = iso_template_serialise(&tmpl, bytes[i % BATCH], sizeof *bytes);
        assert_true(size > 0);
        *item = (struct iso_gallery_item){.person = {.enrolled_s = 1}, .n = 1};
        (void)snprintf(item->person.name, sizeof item->person.name, "person %d", i);
        item->templates[0].algorithm = PUPPET_ALGORITHM;
        item->templates[0].bytes = bytes[i % BATCH];
        item->templates[0].size = (size_t)size;
        if (i % BATCH == BATCH - 1) {
            assert_int_equal(iso_gallery_import(gallery, items, BATCH, false, NULL, &added, NULL),
                             0);
            assert_int_equal(added, BATCH);
        }
    }
    iso_gallery_close(gallery);
}

/* Part of the first person's record, and where it stands in the file. */
static size_t find_record(const char *directory, uint8_t part[PART])
{
    sqlite3 *db = NULL;
    sqlite3_stmt *row = NULL;
    size_t size = 0;
    assert_int_equal(sqlite3_open(scratch_path(directory, "g.db"), &db), SQLITE_OK);
    assert_int_equal(
        sqlite3_prepare_v2(db, "SELECT record FROM template ORDER BY id LIMIT 1", -1, &row, NULL),
        SQLITE_OK);
    assert_int_equal(sqlite3_step(row), SQLITE_ROW);
    const int length = sqlite3_column_bytes(row, 0);
    const uint8_t *record = sqlite3_column_blob(row, 0);
    assert_true(length > 2 * PART);
    memcpy(part, &record[length - 2 * PART], PART);
    assert_int_equal(sqlite3_finalize(row), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    uint8_t *file = scratch_read(scratch_path(directory, "g.db"), &size);
    const uint8_t *at = memmem(file, size, part, PART);
    assert_non_null(at);
    const size_t offset = (size_t)(at - file);
    free(file);
    return offset;
}

static void write_at(const char *directory, size_t offset, const void *bytes, size_t size)
{
    const int file = open(scratch_path(directory, "g.db"), O_WRONLY | O_CLOEXEC);
    assert_true(file >= 0);
    assert_int_equal(pwrite(file, bytes, size, (off_t)offset), size);
    assert_int_equal(close(file), 0);
}

static void what_changed_behind_it_is_not_handed_out(void **state)
{
    static struct iso_template found[2], untouched[2];
    struct iso_fault fault = {.text = ""};
    uint8_t part[PART], flipped;
    int n = 77;
    add_whole_faces(*state);
    const size_t offset = find_record(*state, part);
    struct iso_gallery *gallery = open_gallery(*state);
    const int64_t first = iso_gallery_find(gallery, "person 0")->id;
    const int64_t last = iso_gallery_find(gallery, "person 899")->id;
    flipped = part[0] ^ 0x10;
    write_at(*state, offset, &flipped, 1);
    assert_int_equal(iso_gallery_templates(gallery, first, found, 2, &n, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "damaged"));
    assert_int_equal(n, 77);
    assert_memory_equal(found, untouched, sizeof found);
    assert_int_equal(iso_gallery_templates(gallery, last, found, 2, &n, NULL), 0); /* others are */
    assert_int_equal(n, 1);
    iso_gallery_close(gallery);
    expect_refusal(*state, -EBADMSG, "damaged");
    write_at(*state, offset, part, 1);
    gallery = open_gallery(*state);
    assert_int_equal(iso_gallery_templates(gallery, first, found, 2, &n, NULL), 0);
    assert_int_equal(n, 1);
    iso_gallery_close(gallery);
}

/* Takes the records of a person out of the file, locked as it is. */
static void take_out(const char *directory, int64_t person)
{
    static const int flags = SQLITE_OPEN_READWRITE;
    sqlite3 *db = NULL;
    char sql[80];
    assert_int_equal(sqlite3_open_v2(scratch_path(directory, "g.db"), &db, flags, "unix-none"),
                     SQLITE_OK);
    (void)snprintf(sql, sizeof sql, "DELETE FROM template WHERE person_id = %lld",
                   (long long)person);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_changes(db), 1);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static void what_is_missing_behind_it_is_noticed(void **state)
{
    static struct iso_template found[2], untouched[2];
    struct iso_fault fault = {.text = ""};
    int n = 77;
    add_whole_faces(*state);
    struct iso_gallery *gallery = open_gallery(*state);
    const int64_t first = iso_gallery_find(gallery, "person 0")->id;
    const int64_t last = iso_gallery_find(gallery, "person 899")->id;
    take_out(*state, first);
    /* Not somebody without templates: then a search would go on as if there were nothing wrong. */
    assert_int_equal(iso_gallery_templates(gallery, first, found, 2, &n, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "records are missing"));
    assert_int_equal(n, 77);
    assert_memory_equal(found, untouched, sizeof found);
    assert_int_equal(iso_gallery_templates(gallery, last, found, 2, &n, NULL), 0); /* others are */
    assert_int_equal(n, 1);
    iso_gallery_close(gallery);
    expect_refusal(*state, -EBADMSG, "missing");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(an_empty_file_is_a_lost_gallery),
        TEST(what_changed_behind_it_is_not_handed_out),
        TEST(what_is_missing_behind_it_is_noticed),
        TEST(text_is_no_gallery),
        TEST(a_directory_is_no_gallery),
        TEST(a_database_of_others_is_no_gallery),
        TEST(a_newer_gallery_is_left_alone),
        TEST(wants_its_directory),
        TEST(cut_short_anywhere_it_is_refused),
        TEST(changed_anywhere_it_lies_never),
        TEST(a_damaged_template_is_refused),
        TEST(a_template_without_a_person_is_refused),
        TEST(one_process_has_it),
        TEST(read_only_it_is_refused),
        TEST(a_full_disk_changes_nothing),
        TEST(survives_kills),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
