/* When each person was let in last: a table of times by name. It keeps a keyed hash of each name
 * instead of the name, so that an entry has 16 bytes. Pure. */
#ifndef WEB_DAEMON_SEEN_TABLE_H
#define WEB_DAEMON_SEEN_TABLE_H

#include <stddef.h>
#include <stdint.h>

enum { WEB_SEEN_MOST = 1 << 16 };

struct web_seen_table {
    size_t n, room;
    struct web_seen {
        uint64_t name; /* the hash; the entries are in its order */
        int64_t time_s;
    } * entries;
    uint8_t key[16];
};

/* Begins an empty table, with a random key. */
void web_seen_table_init(struct web_seen_table *table);
void web_seen_table_done(struct web_seen_table *table);

/* Forgets everybody. */
void web_seen_table_clear(struct web_seen_table *table);

/* When the person was let in last, in seconds since 1970; 0: never, or not known. */
int64_t web_seen_table_find(const struct web_seen_table *table, const char *name);

/* The person was let in. An earlier time than the known one changes nothing. Beyond WEB_SEEN_MOST
 * people, and without memory, others are not noted. */
void web_seen_table_note(struct web_seen_table *table, const char *name, int64_t time_s);

/* The person got another name, or was removed, at this time. A later visit under the old name was
 * that of another person, who got the name afterwards: it stays. */
void web_seen_table_rename(struct web_seen_table *table, const char *before, const char *after,
                           int64_t time_s);
void web_seen_table_remove(struct web_seen_table *table, const char *name, int64_t time_s);

#endif
