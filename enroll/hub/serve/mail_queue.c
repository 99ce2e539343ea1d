#include "enroll/hub/serve/mail_queue.h"

#include <search.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/fleet/message/envelope.h"

bool hub_mail_topic(const char *topic, struct iso_fleet_id *door, bool *is_presence)
{
    static const char begin[] = "isotherm/door/";
    char id[ISO_FLEET_ID_TEXT_SIZE];

    if (strncmp(topic, begin, sizeof begin - 1) != 0 ||
        strnlen(topic, sizeof begin + sizeof id) < sizeof begin + sizeof id - 1) {
        return false;
    }
    memcpy(id, topic + sizeof begin - 1, sizeof id - 1);
    id[sizeof id - 1] = '\0';
    const char *rest = topic + sizeof begin - 1 + sizeof id - 1;
    const bool is_online = strcmp(rest, "/online") == 0;
    if ((!is_online && strcmp(rest, "/out") != 0) || iso_fleet_id_read(id, door)) {
        return false;
    }
    *is_presence = is_online;
    return true;
}

static int compare_doors(const void *a, const void *b)
{
    const struct hub_mail *x = a, *y = b;

    return memcmp(&x->door, &y->door, sizeof x->door);
}

/* The question of the door that waits, or NULL. */
static struct hub_mail *question_of(const struct hub_mail_queue *queue,
                                    const struct iso_fleet_id *door)
{
    const struct hub_mail wanted = {.door = *door};
    void *const *found = tfind(&wanted, &queue->questions, compare_doors);

    return found ? *found : NULL;
}

static void wipe_bytes(struct hub_mail *mail)
{
    if (mail->bytes) {
        sodium_memzero(mail->bytes, mail->size);
        free(mail->bytes);
    }
}

/* Appends a message, whose bytes belong to the queue then. False: there is no memory. */
static bool append(struct hub_mail_queue *queue, const struct hub_mail *with)
{
    struct hub_mail *mail = malloc(sizeof *mail);

    if (!mail) {
        return false;
    }
    *mail = *with;
    if (mail->is_question && !tsearch(mail, &queue->questions, compare_doors)) {
        free(mail);
        return false;
    }
    *(queue->first ? queue->end : &queue->first) = mail;
    queue->end = &mail->next;
    queue->n++;
    queue->bytes += mail->size;
    return true;
}

static void replace(struct hub_mail_queue *queue, struct hub_mail *earlier,
                    const struct hub_mail *with)
{
    queue->bytes += with->size - earlier->size;
    queue->replaced++;
    wipe_bytes(earlier);
    earlier->size = with->size;
    earlier->bytes = with->bytes;
}

bool hub_mail_put(struct hub_mail_queue *queue, const struct iso_fleet_id *door, bool is_presence,
                  const void *bytes, size_t size)
{
    struct hub_mail mail = {.door = *door, .is_presence = is_presence, .size = size};
    struct hub_mail *earlier = NULL;
    enum iso_fleet_kind kind;

    mail.is_question = !is_presence && iso_fleet_kind_of(bytes, size, &kind) == 0 &&
                       kind == ISO_FLEET_QUESTION;
    if (mail.is_question) {
        earlier = question_of(queue, door);
    }
    if (size <= HUB_MAIL_BYTES_MAX && queue->bytes <= HUB_MAIL_BYTES_MAX - size) {
        mail.bytes = malloc(size + 1); /* of size 0, too */
    }
    if (mail.bytes) {
        memcpy(mail.bytes, bytes, size);
    }
    if (mail.bytes && earlier) {
        replace(queue, earlier, &mail);
        return true;
    }
    if (mail.bytes && append(queue, &mail)) {
        return true;
    }
    wipe_bytes(&mail);
    queue->dropped++;
    return false;
}

void hub_mail_drop_first(struct hub_mail_queue *queue)
{
    struct hub_mail *mail = queue->first;

    if (!mail) {
        return;
    }
    if (mail->is_question) {
        (void)tdelete(mail, &queue->questions, compare_doors);
    }
    queue->first = mail->next;
    queue->n--;
    queue->bytes -= mail->size;
    wipe_bytes(mail);
    free(mail);
}

void hub_mail_clear(struct hub_mail_queue *queue)
{
    while (queue->first) {
        hub_mail_drop_first(queue);
    }
}
