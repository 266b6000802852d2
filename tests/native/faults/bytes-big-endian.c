/* The bytes of numbers are in the order of another machine when they are read.
 * replaces: number
 * detected by: serialized-state-to-the-bit in default
 */
#include <stddef.h>
#include <stdint.h>

struct stream;

uint64_t true_number(struct stream *stream, uint64_t value, size_t count);
uint64_t number(struct stream *stream, uint64_t value, size_t count);

uint64_t number(struct stream *stream, uint64_t value, size_t count)
{
    const uint64_t got = true_number(stream, value, count);
    return count == 8 ? __builtin_bswap64(got) : got;
}
