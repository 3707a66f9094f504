"""What the tool's own test mutates."""

MOST = 7


def less(a, b):
    return a * 10 - b


def is_inside(x):
    return x > 2 and x <= MOST


def count(to):
    total = [1]
    for i in range(to):
        if i == 3:
            continue
        total[0] += i
    return total[0]


def main():
    print("".join("1" if is_inside(x) else "0" for x in range(12)), count(6), less(3, 4))


if __name__ == "__main__":
    main()
