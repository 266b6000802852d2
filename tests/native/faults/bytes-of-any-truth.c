/* A truth value of a state may be any byte.
 * replaces: truth
 * detected by: damaged-states
 */
#include <stdbool.h>
#include <stddef.h>

struct stream {
    int way;
    unsigned char *to;
    const unsigned char *from;
    size_t at;
    bool sound;
};

void true_truth(struct stream *stream, bool *value);
void truth(struct stream *stream, bool *value);

void truth(struct stream *stream, bool *value)
{
    const bool sound = stream->sound;
    true_truth(stream, value);
    stream->sound = sound;
}
