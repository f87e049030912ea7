# make bend   build and run the main job, a strand bent by turning its ends -> out/bent_strand
# make test   run all tests
# make studies   run the studies of accuracy against cost, tables and charts to docs/studies (half an hour)
# make stress   run the families of extreme scenes, table to docs/stress.md (five minutes)
# Without make: sh scripts/bend.sh, sh scripts/test.sh.

RESULT ?= out/bent_strand/results.vtkhdf
PICTURE ?= $(RESULT:.vtkhdf=.png)

.PHONY: bend test check bench bench-draw picture studies stress clean setup

bend:
	@sh scripts/bend.sh

test:
	@sh scripts/test.sh

# Formatting, lints over every set of features, documentation, arrows between the crates.
check:
	@sh scripts/check.sh

# Measures, keeps the figures in benches/history.jsonl and compares them with those before; make bench-draw draws them.
bench: setup
	cargo bench --workspace
	python3 scripts/bench_record.py

bench-draw:
	python3 scripts/bench_record.py draw

# Renders the last step of RESULT; runs the main job first when there is no result yet.
picture:
	@test -f "$(RESULT)" || sh scripts/bend.sh
	@python=$$(sh scripts/venv.sh) && "$$python" scripts/render_strand.py "$(RESULT)" "$(PICTURE)"

# STUDIES chooses some by name.
studies:
	@sh scripts/studies.sh $(STUDIES)

# Exit code 1 when a member FAILS.
stress:
	@sh scripts/stress.sh

clean:
	cargo clean
	rm -rf out

setup:
	@sh scripts/setup.sh
