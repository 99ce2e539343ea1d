#include "firmware/stream/stream_list.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static void remove_stream(struct iso_stream_list *list, int i)
{
    (void)close(list->streams[i].fd);
    list->streams[i] = list->streams[--list->n];
}

/* Removes the streams that their clients have closed. */
static void remove_closed(struct iso_stream_list *list)
{
    for (int i = list->n - 1; i >= 0; i--) {
        struct pollfd end = {.fd = list->streams[i].fd};
        if (poll(&end, 1, 0) == 1 && (end.revents & (POLLHUP | POLLERR))) {
            remove_stream(list, i);
        }
    }
}

static int check_room(const struct iso_stream_list *list, uid_t user, struct iso_fault *fault)
{
    int of_user = 0;
    for (int i = 0; i < list->n; i++) {
        of_user += list->streams[i].user == user;
    }
    if (list->n == ISO_STREAMS_MAX) {
        return iso_fault_set(fault, -EBUSY, "%d streams are open already", list->n);
    }
    return of_user < ISO_STREAMS_PER_USER
               ? 0
               : iso_fault_set(fault, -EBUSY, "user %u has %d streams already", (unsigned)user,
                               of_user);
}

/* Room for a few records: a client that is slow gets new records rather than old ones. The kernel
 * doubles the number. */
static int room_of(enum iso_stream_kind kind)
{
    return kind == ISO_STREAM_OUTLINE ? 4096 : 64 * 1024;
}

int iso_stream_list_add(struct iso_stream_list *list, enum iso_stream_kind kind, uid_t user,
                        struct iso_fault *fault)
{
    int ends[2];
    remove_closed(list);
    const int error = check_room(list, user, fault);
    if (error) {
        return error;
    }
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends)) {
        return iso_fault_set(fault, -errno, "no socket for a stream: %s", strerror(errno));
    }
    const int room = room_of(kind);
    (void)setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
    (void)shutdown(ends[0], SHUT_RD); /* the client has nothing to say */
    list->streams[list->n++] = (struct iso_stream){.fd = ends[0], .kind = kind, .user = user};
    return ends[1];
}

bool iso_stream_list_has(const struct iso_stream_list *list, enum iso_stream_kind kind)
{
    for (int i = 0; i < list->n; i++) {
        if (list->streams[i].kind == kind) {
            return true;
        }
    }
    return false;
}

/* Returns false if the client has closed the stream. */
static bool send_one(struct iso_stream *stream, uint8_t *bytes, size_t size)
{
    iso_stream_record_set_missed(bytes, stream->missed);
    if (send(stream->fd, bytes, size, MSG_DONTWAIT | MSG_NOSIGNAL) == (ssize_t)size) {
        stream->missed = 0;
        return true;
    }
    stream->missed = (uint16_t)(stream->missed < UINT16_MAX ? stream->missed + 1 : UINT16_MAX);
    return errno == EAGAIN || errno == EINTR || errno == ENOBUFS || errno == ENOMEM;
}

void iso_stream_list_send(struct iso_stream_list *list, enum iso_stream_kind kind, uint8_t *bytes,
                          size_t size)
{
    for (int i = list->n - 1; i >= 0; i--) {
        struct iso_stream *stream = &list->streams[i];
        if (stream->kind == kind && !send_one(stream, bytes, size)) {
            remove_stream(list, i);
        }
    }
}

void iso_stream_list_end(struct iso_stream_list *list, enum iso_stream_kind kind)
{
    for (int i = list->n - 1; i >= 0; i--) {
        if (list->streams[i].kind == kind) {
            remove_stream(list, i);
        }
    }
}
